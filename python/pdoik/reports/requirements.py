"""What goals ask of a robot, and by how much links are off it, by plain matrices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import Goal
from .._rotations import rotation_vector
from ..options import Options
from .call import Call
from .values import FloatArray

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """One goal with all that it left to its call and to the options.

    Attributes:
        link: The tip's; of the centre of mass it says nothing.
        relative_to: In whose frame the target is; None for the base's.
        kind: "pose", "axis", "position", "look_at" or "center_of_mass".
        target: (4, 4) [m].
        tool: What of the tip has to be there, in the link's frame, (4, 4) [m].
        axis: In the tool's frame, (3,).
        position_slack: Along the target's axes, (3,) [m].
        rotation_slack: About them, (3,) [rad].
        position_tolerance: Of a success [m].
        rotation_tolerance: Of a success [rad].
        is_wish: Whether success does not look at it.
        position_first: Whether its orientation comes second.
    """

    link: str
    relative_to: str | None
    kind: str
    target: FloatArray
    tool: FloatArray
    axis: FloatArray
    position_slack: FloatArray
    rotation_slack: FloatArray
    position_tolerance: float
    rotation_tolerance: float
    is_wish: bool
    position_first: bool

    def errors(self, poses: Mapping[str, FloatArray]) -> tuple[float, float]:
        """Errors beyond slack, position [m] and rotation [rad].

        Args:
            poses: T_base_link of every link, (4, 4) [m].
        """
        if not np.isfinite(self.target).all():
            return np.inf, np.inf
        T = poses[self.link] @ self.tool
        target = self.target
        if self.relative_to is not None:
            target = poses[self.relative_to] @ target
        off, R = T[:3, 3] - target[:3, 3], target[:3, :3]
        if self.kind == "look_at":
            return 0.0, self._off_axis(T, -off)
        beyond = np.maximum(np.abs(R.T @ off) - self.position_slack, 0.0)
        position = float(np.linalg.norm(beyond))
        if self.kind == "position":
            return position, 0.0
        if self.kind == "axis":
            return position, self._off_axis(T, R @ self.axis)
        turn = np.maximum(np.abs(rotation_vector(R.T @ T[:3, :3])) - self.rotation_slack, 0.0)
        return position, float(np.linalg.norm(turn))

    def _off_axis(self, T: FloatArray, wanted: FloatArray) -> float:
        """Error of the axis beyond its cone [rad]."""
        is_at = T[:3, :3] @ self.axis
        angle = np.arctan2(np.linalg.norm(np.cross(is_at, wanted)), is_at @ wanted)
        return max(float(angle) - float(self.rotation_slack.max()), 0.0)


def requirements(
    goals: Any, tips: Sequence[str], options: Options, call: Call
) -> list[Requirement]:
    """Requirements of whatever a solve takes as its target.

    Args:
        goals: A target, a Goal, a list of them, or a dict of such by tip link.
        tips: The robot's tip links.
        options: What goals leave to them.
        call: What they leave to the call.
    """
    by_link = goals if isinstance(goals, Mapping) else {None: goals}
    return [
        _requirement(goal, link, tips, options, call)
        for link, some in by_link.items()
        for goal in (some if _is_list(some) else [some])
    ]


def _is_list(goals: Any) -> bool:
    return isinstance(goals, list | tuple) and bool(goals) and isinstance(goals[0], Goal)


def _requirement(
    goal: Any, link: str | None, tips: Sequence[str], options: Options, call: Call
) -> Requirement:
    full = goal if isinstance(goal, Goal) else None
    given = np.asarray(goal if full is None else full.T_base_tip)
    target = np.eye(4)
    if given.shape == (3,):
        target[:3, 3] = given
    else:
        target = given
    tip = (full and full.tip) or link or tips[0]
    kind = (full and full.type) or options.goal
    axis: Any = options.goal_axis if full is None or full.axis is None else full.axis
    tools = call.T_tip_tool
    usual = tools.get(tip) if isinstance(tools, Mapping) else tools
    own = None if full is None else full.T_tip_tool
    tool = next(each for each in (own, usual, options.T_tip_tool) if each is not None)
    priority = (full and full.priority) or call.priority or options.priority
    return Requirement(
        link=tip,
        relative_to=full.relative_to if full else None,
        kind=kind,
        target=target,
        tool=np.asarray(tool),
        axis=np.array(_AXES[axis] if isinstance(axis, str) else axis, dtype=np.float64),
        position_slack=full.position_slack if full else np.zeros(3),
        rotation_slack=full.rotation_slack if full else np.zeros(3),
        position_tolerance=(full and full.position_tolerance) or options.position_tolerance,
        rotation_tolerance=(full and full.rotation_tolerance) or options.rotation_tolerance,
        is_wish=bool(full and full.soft),
        position_first=priority == "position" and kind in ("pose", "axis"),
    )
