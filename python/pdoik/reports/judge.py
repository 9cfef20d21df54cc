"""What an answer is worth, by code that shares nothing with the solver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import Goal, Robot
from ..options import Options
from .distances import segment_to_shape, to_capsule, to_spheroid
from .kinematics import Kinematics
from .obstacles import Obstacles
from .self_distance import Capsule, SelfDistance
from .values import FloatArray

ROUNDING = 1e-8  # what two ways to compute one figure may differ by [m] or [rad]
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_FIRST_LOOK = 64  # points of a hull


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """The figures of one answer.

    Attributes:
        position_error: The largest over the goals, beyond slack [m].
        rotation_error: [rad].
        limit_violation: [rad] or [m].
        clearance: Least distance of an obstacle to a hull [m]; None if it is not judged.
        self_distance: Least distance between links, where it is asked for [m]; None likewise.
        faults: What was claimed and does not hold, in words.
    """

    position_error: float
    rotation_error: float
    limit_violation: float
    clearance: float | None
    self_distance: float | None
    faults: tuple[str, ...]


class Judge:
    """Judges answers of one robot.

    Args:
        robot: Its description and hulls are taken.
        options: What was asked for.
        carries: Whether links carry something.
    """

    def __init__(self, robot: Robot, options: Options, *, carries: bool) -> None:
        from .._hulls import wide_hulls

        self.robot = robot
        self.options = options
        self.kinematics = Kinematics(robot)
        occupancy = robot.occupancy
        wide = [(link, p, link, p, radius) for link, p, radius in occupancy.spheres]
        wide += occupancy.spheroids
        only_look = wide_hulls(robot)  # those around capsules
        hulls = [(*hull, 0.0, False) for k, hull in enumerate(wide) if k not in only_look]
        hulls += [(link, a, link, b, r, over, True) for link, a, b, r, over in occupancy.capsules]
        self._forgiven: list[tuple[Any, ...]] = []  # those of them that count as thinner, whole
        self._hulls = self._counted(hulls)
        self._self_distance: SelfDistance | None = None
        self._keeps_off_itself = options.keeps_off_itself(robot)
        capsules = [
            Capsule(link, a, b, size)
            for link, a, other, b, size, _, swept in hulls
            if swept or (link == other and a == b)
        ]
        if self._keeps_off_itself and len(capsules) == len(hulls):
            self._self_distance = SelfDistance(robot, self.kinematics, capsules)
        self.unjudged = self._unjudged(carries)

    def _unjudged(self, carries: bool) -> tuple[str, ...]:
        options = self.options
        own = options.method == "paper" or options.inner == "lbfgs"
        found = {
            "clearance, since something may be touched": options.touch.radius > 0,
            "clearance, since the paper's hulls are not the robot's capsules": own
            and len(self.robot.occupancy.capsules) > 0,
            "what links carry": carries,
            "distances between links, of spheroids": self._keeps_off_itself
            and self._self_distance is None,
            "balance": bool(options.balance.contacts)
            or bool(np.isfinite([*options.balance.com_lower, *options.balance.com_upper]).any()),
        }
        return tuple(what for what, is_so in found.items() if is_so)

    def _counted(self, hulls: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
        """Those that obstacles must keep off; thinner by overhang where the target places them."""
        rng = np.random.default_rng(0)
        seen = [self.kinematics.poses(rng.uniform(-1, 1, self.robot.dof)) for _ in range(4)]

        def still(hull: tuple[Any, ...], to: str | None) -> bool:
            for link, point in (hull[:2], hull[2:4]):
                at = []
                for poses in seen:
                    world = poses[link] @ [*point, 1.0]
                    at.append(world if to is None else np.linalg.inv(poses[to]) @ world)
                if np.ptp(at, axis=0).max() > 1e-10:
                    return False
            return True

        counted = []
        for link_a, a, link_b, b, size, over, swept in hulls:
            hull = (link_a, a, link_b, b)
            fixed = still(hull, None)
            if fixed and not self.options.base_collision:
                continue
            placed = fixed or any(still(hull, tip) for tip in self.robot.tip_links)
            if placed and self.options.forgive_overhang and over > 0.0:
                self._forgiven.append((*hull, size, swept))
                size -= min(over, 0.5 * size)
            counted.append((*hull, size, swept))
        return counted

    @np.errstate(over="ignore", invalid="ignore")
    def __call__(self, goals: Any, answer: Mapping[str, Any], obstacles: Obstacles) -> Judged:
        """Of one answer to goals among obstacles."""
        q, refused = answer["q"], answer.get("tracking") == "invalid_input"
        if refused or not np.isfinite(q).all():
            beyond = self.kinematics.limit_violation(q)
            fault = () if beyond <= 0.0 else ("q is not finite or beyond its limits",)
            return Judged(
                position_error=np.nan,
                rotation_error=np.nan,
                limit_violation=beyond,
                clearance=None,
                self_distance=None,
                faults=fault,
            )
        poses = self.kinematics.poses(q)
        tips = goals if isinstance(goals, Mapping) else {self.robot.tip_links[0]: goals}
        errors = [self._goal_errors(goal, poses[link]) for link, goal in tips.items()]
        figures: dict[str, Any] = {
            "position_error": max(error[0] for error in errors),
            "rotation_error": max(error[1] for error in errors),
            "limit_violation": self.kinematics.limit_violation(q),
            "clearance": self._clearance(self._hulls, poses, obstacles),
            "self_distance": None if self._self_distance is None else self._self_distance(poses),
        }
        faults = self._faults(answer, figures) + self._unnamed(answer, poses, obstacles)
        return Judged(**figures, faults=tuple(faults))

    def _faults(self, answer: Mapping[str, Any], found: Mapping[str, Any]) -> list[str]:
        options, faults = self.options, []
        claims = answer.get("tracking", "tracking" if answer["success"] else "") == "tracking"
        for name, unit, most in (
            ("position_error", "m", options.position_tolerance),
            ("rotation_error", "rad", options.rotation_tolerance),
            ("limit_violation", "rad or m", 0.0),
        ):
            title = name.replace("_", " ")
            if claims and found[name] > most + ROUNDING:
                faults.append(
                    f"claims success, but {title} is {found[name]:.4g} {unit}, allowed {most:g}"
                )
            if abs(found[name] - answer[name]) > ROUNDING * (1.0 + abs(found[name])):
                faults.append(f"says {title} is {answer[name]:.9g} {unit}; it is {found[name]:.9g}")
        for name, wanted in (
            ("clearance", options.clearance),
            ("self_distance", options.self_clearance),
        ):
            distance, said, title = found[name], answer[name], name.replace("_", " ")
            if distance is None:
                continue
            if claims and distance < wanted - options.clearance_tolerance - ROUNDING:
                faults.append(f"claims success, but {title} is {distance:.4g} m, wanted {wanted:g}")
            far = "tracking" in answer and min(distance, said) >= 0.5 - ROUNDING  # told as 0.5
            near = np.isclose(said, distance, rtol=ROUNDING, atol=ROUNDING)
            both_off = min(distance, said) > ROUNDING  # depth can be measured in several ways
            if (both_off and not far and not near) or (
                max(distance, said) > ROUNDING and min(distance, said) < -ROUNDING
            ):
                faults.append(f"says {title} is {said:.9g} m; it is {distance:.9g}")
        return faults

    def _unnamed(
        self, answer: Mapping[str, Any], poses: Mapping[str, FloatArray], obstacles: Obstacles
    ) -> list[str]:
        """Contact of whole capsules that a success passes over otherwise than it says."""
        said, whole = answer.get("forgiven_depth"), None
        if said is not None and answer["success"]:
            whole = self._clearance(self._forgiven, poses, obstacles)
        if said is None or whole is None:
            return []
        options = self.options
        depth = max(options.clearance - options.clearance_tolerance - whole, 0.0)
        if abs(depth - said) <= ROUNDING and bool(answer["forgiven_contact"]) == (said > 0.0):
            return []
        named = answer["forgiven_contact"] or "nothing"
        return [f"says that {named} is forgiven, by {said:.9g} m; it is {depth:.9g} m"]

    def _goal_errors(self, goal: Any, T: FloatArray) -> tuple[float, float]:
        """Beyond slack, position [m] and rotation [rad]."""
        bare = not isinstance(goal, Goal)
        given = np.asarray(goal if bare else goal.T_base_tip)
        kind = self.options.goal if bare or goal.type is None else goal.type
        position_slack, rotation_slack = np.zeros(3), np.zeros(3)
        if not bare:
            position_slack, rotation_slack = goal.position_slack, goal.rotation_slack
        if not np.isfinite(given).all():
            return np.inf, np.inf
        target = np.eye(4)
        if given.shape == (3,):
            target[:3, 3] = given
        else:
            target = given
        R = target[:3, :3]
        off = np.maximum(np.abs(R.T @ (T[:3, 3] - target[:3, 3])) - position_slack, 0.0)
        position = float(np.linalg.norm(off))
        if kind == "position":
            return position, 0.0
        if kind == "axis":
            axis = self.options.goal_axis if bare or goal.axis is None else goal.axis
            axis = np.array(_AXES[axis] if isinstance(axis, str) else axis, dtype=np.float64)
            is_at, wanted = T[:3, :3] @ axis, R @ axis
            angle = np.arctan2(np.linalg.norm(np.cross(is_at, wanted)), is_at @ wanted)
            return position, max(float(angle) - float(rotation_slack.max()), 0.0)
        turn = np.maximum(np.abs(_rotation_vector(R.T @ T[:3, :3])) - rotation_slack, 0.0)
        return position, float(np.linalg.norm(turn))

    def _clearance(
        self,
        hulls: list[tuple[Any, ...]],
        poses: Mapping[str, FloatArray],
        obstacles: Obstacles,
    ) -> float | None:
        """Least over hulls and obstacles [m]; None where it is none of this judge's."""
        if any(what.startswith(("clearance", "what links")) for what in self.unjudged):
            return None
        least = np.inf
        for link_a, a, link_b, b, size, swept in hulls:
            A, B = (poses[link] @ [*p, 1.0] for link, p in ((link_a, a), (link_b, b)))
            least = min(least, _to_points(obstacles.points, A[:3], B[:3], size, swept, least))
            for shape in obstacles.shapes:
                contacts = [c for c in obstacles.allowed if c[1] == shape.name]
                mine = [c for c in contacts if c[0] in (link_a, link_b)]
                if any(len(c) == 3 for c in mine) or (not swept and link_a != link_b):
                    return None
                if not swept and not np.array_equal(a, b):
                    return None
                if not mine:
                    near = segment_to_shape(A[:3], B[:3], shape, least + size)
                    least = min(least, near - size)
        return least


def _to_points(
    points: FloatArray, a: FloatArray, b: FloatArray, size: float, swept: bool, least: float
) -> float:
    """Of a hull, if it is less than `least`: only points that may be so near are looked at."""
    if len(points) == 0:
        return least
    centres, radii = points[:, :3], points[:, 3]
    if swept:
        return float((to_capsule(centres, a, b, size) - radii).min())
    if float(np.linalg.norm(b - a)) >= 2.0 * size:
        return least
    # Half the sum of distances to the foci, less the semi-major axis, is no more than the distance.
    to = [np.linalg.norm(centres - focus, axis=1) for focus in (a, b)]
    bound = 0.5 * (to[0] + to[1]) - size - radii
    first = np.argsort(bound)[:_FIRST_LOOK]
    near = min(least, float((to_spheroid(centres[first], a, b, size) - radii[first]).min()))
    rest = (bound <= near) | (bound + radii <= 0.0)
    return min(
        near, float((to_spheroid(centres[rest], a, b, size) - radii[rest]).min(initial=np.inf))
    )


def _rotation_vector(R: FloatArray) -> FloatArray:
    """Axis times angle of a rotation, by its quaternion, (3,) [rad]."""
    K = np.array(
        [
            [R[0, 0] - R[1, 1] - R[2, 2], 0.0, 0.0, 0.0],
            [R[0, 1] + R[1, 0], R[1, 1] - R[0, 0] - R[2, 2], 0.0, 0.0],
            [R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], R[2, 2] - R[0, 0] - R[1, 1], 0.0],
            [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], np.trace(R)],
        ]
    )
    x, y, z, w = np.linalg.eigh(K, UPLO="L")[1][:, -1]
    v = np.array([x, y, z]) * (1.0 if w >= 0 else -1.0)
    sine = float(np.linalg.norm(v))
    return v * (2.0 if sine < 1e-12 else 2.0 * np.arctan2(sine, abs(w)) / sine)
