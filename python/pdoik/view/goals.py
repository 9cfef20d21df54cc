"""What is asked of each tip, and how the solver is given it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, cast, get_args

import numpy as np
import numpy.typing as npt

import pdoik

from .humanoid import is_h1

FloatArray = npt.NDArray[np.float64]
GoalKind = Literal["pose", "axis", "position", "look_at", "free"]
Request = dict[str, pdoik.Goal]  # by tip link

GOALS: tuple[GoalKind, ...] = get_args(GoalKind)
WITH_CONE = ("axis", "look_at")
MOST_REQUESTS = 64  # ways to choose a target for each tip
_NEEDS = {"pose": 6, "axis": 5}  # joints
_DRAGGED_WEIGHT = 0.05  # against the other tips' 1: where not all can be had, they hold
_ANYWHERE = [1e3, 1e3, 1e3]  # [m]
_AHEAD = 0.3  # of a tip that looks there, to begin with [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TipGoal:
    """What is asked of a tip: any one of its targets."""

    kind: GoalKind
    targets: tuple[FloatArray, ...]  # T_base_tip, (4, 4) each; of look_at the origin counts
    cone: float = 0.0  # how far an axis may point off [rad]


def default_goals(robot: pdoik.Robot, goal: str) -> dict[str, GoalKind]:
    """The goal for tips that have the joints for it, the position for others and H1's elbows."""
    q = robot.mid_configuration()

    def kind(tip: str) -> GoalKind:
        movers = int((np.abs(robot.jacobian(q, tip)).max(axis=0) > 1e-12).sum())
        short = movers < _NEEDS.get(goal, 0)
        return "position" if short or (is_h1(robot) and "elbow" in tip) else cast(GoalKind, goal)

    return {tip: kind(tip) for tip in robot.tip_links}


def requests(goals: Mapping[str, TipGoal], dragged: str | None) -> list[Request]:
    """What the solver takes, one for each choice of targets, without the free tips."""
    asked = {tip: goal for tip, goal in goals.items() if goal.kind != "free"}
    if not asked:  # the solver wants one: anywhere
        tip, free = next(iter(goals.items()))
        return [{tip: pdoik.Goal(free.targets[0], type="position", position_slack=_ANYWHERE)}]
    several = len(asked) > 1

    def one(tip: str, which: int) -> pdoik.Goal:
        goal = asked[tip]
        return pdoik.Goal(
            goal.targets[which],
            type=goal.kind,
            weight=_DRAGGED_WEIGHT if several and tip == dragged else 1.0,
            rotation_slack=[goal.cone] * 3 if goal.kind in WITH_CONE and goal.cone > 0 else None,
        )

    counts = [len(goal.targets) for goal in asked.values()]
    return [
        {tip: one(tip, which) for tip, which in zip(asked, choice, strict=True)}
        for choice in np.ndindex(*counts)
    ]


def choice_of(goals: Mapping[str, TipGoal], request: int) -> dict[str, int]:
    """Which target of each tip the request of that number asks for."""
    counts = _counts(goals)
    choice = np.unravel_index(request, tuple(counts.values())) if counts else ()
    return dict.fromkeys(goals, 0) | {
        tip: int(which) for tip, which in zip(counts, choice, strict=True)
    }


def request_of(goals: Mapping[str, TipGoal], choice: Mapping[str, int]) -> int:
    """The number of the request that asks for these targets."""
    number = 0
    for tip, count in _counts(goals).items():
        number = number * count + min(choice.get(tip, 0), count - 1)
    return number


def count_requests(goals: Mapping[str, TipGoal]) -> int:
    return math.prod(_counts(goals).values())


def choice_text(goals: Mapping[str, TipGoal], choice: Mapping[str, int]) -> str:
    """'goal 2 of 4', with the tips' names where several have a choice; '' where none has."""
    offered = {tip: count for tip, count in _counts(goals).items() if count > 1}
    each = [f"goal {choice[tip] + 1} of {count}" for tip, count in offered.items()]
    if len(goals) > 1:
        each = [f"{words} ({tip})" for words, tip in zip(each, offered, strict=True)]
    return ", ".join(each)


def home(
    kind: GoalKind, robot: pdoik.Robot, q: FloatArray, tip: str, axis: str | npt.ArrayLike
) -> FloatArray:
    """A target of a tip that it meets at q: where it is, or a point straight ahead, (4, 4)."""
    T = np.array(robot.fk(q, tip))
    if kind == "look_at":
        along = np.eye(3)["xyz".index(axis)] if isinstance(axis, str) else np.asarray(axis)
        T[:3, 3] += _AHEAD * T[:3, :3] @ (along / np.linalg.norm(along))
    return T


def _counts(goals: Mapping[str, TipGoal]) -> dict[str, int]:
    """How many targets each tip has that is not free."""
    return {tip: len(goal.targets) for tip, goal in goals.items() if goal.kind != "free"}
