"""What an answer is worth, by code that shares nothing with the solver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._core import ContactRule, Robot
from ..options import Options
from .call import Call
from .contacts import Wanted
from .distances import segment_to_shape, to_capsule, to_hull
from .kinematics import Kinematics
from .link_bodies import LinkBodies
from .mass import MassBox
from .obstacles import Obstacles
from .requirements import Requirement, requirements
from .self_distance import Capsule, SelfDistance
from .values import FloatArray

_OF_FIELDS = "contact of distance fields within capsules, where links' own pieces decide"
ROUNDING = 1e-8  # what two ways to compute one figure may differ by [m] or [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """The figures of one answer.

    Attributes:
        position_error: The largest over the goals that are no wishes, beyond slack [m].
        rotation_error: [rad].
        limit_violation: [rad] or [m].
        clearance: Least distance of an obstacle to a hull [m]; None if it is not judged.
        room: Least of what such a distance is beyond what is wanted of the two [m]; None likewise.
        self_distance: Least distance between links, where it is asked for [m]; None likewise.
        self_room: As `room` [m]; None likewise.
        balance_violation: How far the centre of mass is outside its box [m]; None likewise.
        faults: What was claimed and does not hold, in words.
    """

    position_error: float
    rotation_error: float
    limit_violation: float
    clearance: float | None
    room: float | None
    self_distance: float | None
    self_room: float | None
    balance_violation: float | None
    faults: tuple[str, ...]


class Judge:
    """Judges answers of one robot.

    Args:
        robot: Its description and hulls are taken.
        options: What was asked for.
        carries: Whether something is attached to links.
        contacts: Rules of contact, in the order in which they count.
    """

    def __init__(
        self,
        robot: Robot,
        options: Options,
        *,
        carries: bool,
        contacts: Sequence[ContactRule] = (),
    ) -> None:
        from .._hulls import wide_hulls

        self.robot = robot
        self.options = options
        self.kinematics = Kinematics(robot)
        occupancy = robot.occupancy
        wide = [(link, p, link, p, radius) for link, p, radius in occupancy.spheres]
        wide += occupancy.spheroids
        only_look = wide_hulls(robot)  # those around capsules
        hulls = [(*hull, False) for k, hull in enumerate(wide) if k not in only_look]
        hulls += [(link, a, link, b, r, True) for link, a, b, r, _ in occupancy.capsules]
        self._own = LinkBodies(occupancy, options)
        self._hulls = self._counted(hulls)
        self._wanted = Wanted(robot.ignored_pairs, contacts)
        self._self_distance: SelfDistance | None = None
        self._mass_box = MassBox(robot, options)
        self._keeps_off_itself = options.keeps_off_itself(robot)
        capsules = [
            Capsule(link, a, b, size)
            for link, a, other, b, size, swept in hulls
            if swept or (link == other and a == b)
        ]
        if self._keeps_off_itself and len(capsules) == len(hulls):
            self._self_distance = SelfDistance(
                robot,
                self.kinematics,
                capsules,
                self._wanted,
                options.self_clearance,
                self._own,
            )
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
            "balance": not self._mass_box.is_judged,
        }
        return tuple(what for what, is_so in found.items() if is_so)

    def _counted(self, hulls: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
        """Those that obstacles must keep off."""
        rng = np.random.default_rng(0)
        seen = [self.kinematics.poses(rng.uniform(-1, 1, self.robot.dof)) for _ in range(4)]

        def stands_still(hull: tuple[Any, ...]) -> bool:
            for link, point in (hull[:2], hull[2:4]):
                at = [poses[link] @ [*point, 1.0] for poses in seen]
                if np.ptp(at, axis=0).max() > 1e-10:
                    return False
            return True

        return [hull for hull in hulls if self.options.base_collision or not stands_still(hull)]

    @np.errstate(over="ignore", invalid="ignore")
    def __call__(
        self, goals: Any, answer: Mapping[str, Any], obstacles: Obstacles, call: Call | None = None
    ) -> Judged:
        """Judgement of one answer to goals among obstacles.

        Args:
            goals: Of a solve; of several that would do, the one that was met.
            answer: By the names of a Result.
            obstacles: That it was asked among.
            call: What else was asked; None for nothing.
        """
        call = call or Call()
        q, refused = answer["q"], answer.get("tracking") == "invalid_input"
        if refused or not np.isfinite(q).all():
            beyond = self.kinematics.limit_violation(q)
            fault = () if beyond <= 0.0 else ("q is not finite or beyond its limits",)
            return Judged(
                position_error=np.nan,
                rotation_error=np.nan,
                limit_violation=beyond,
                clearance=None,
                room=None,
                self_distance=None,
                self_room=None,
                balance_violation=None,
                faults=fault,
            )
        poses = self.kinematics.poses(q)
        asked = requirements(goals, self.robot.tip_links, self.options, call)
        errors = [
            (goal, *goal.errors(poses))
            for goal in asked
            if not goal.is_wish and goal.kind != "center_of_mass"
        ]
        mass = self._mass_box(asked, poses)
        nothing = (None, None, False)
        clearance, room, by_pieces = self._clearance(poses, obstacles) or nothing
        own = None if self._self_distance is None else self._self_distance(poses)
        self_distance, self_room, self_by_pieces = own or nothing
        both = {"clearance": by_pieces, "self_distance": self_by_pieces}
        exact = {name for name, is_so in both.items() if is_so}
        figures: dict[str, Any] = {
            "position_error": max((position for _, position, _ in errors), default=0.0),
            "rotation_error": max((rotation for *_, rotation in errors), default=0.0),
            "limit_violation": self.kinematics.limit_violation(q),
            "clearance": clearance,
            "room": room,
            "self_distance": self_distance,
            "self_room": self_room,
            "balance_violation": None if mass is None else mass[1],
        }
        faults = [
            *_false_claims(answer, errors),
            *self._faults(answer, figures, exact),
        ]
        if mass is not None and np.abs(mass[0] - answer["center_of_mass"]).max() > ROUNDING:
            at = answer["center_of_mass"].tolist()
            faults.append(f"says the centre of mass is at {at}; it is at {mass[0].tolist()}")
        faults += self._unlocked(answer, call)
        return Judged(**figures, faults=tuple(faults))

    def _faults(
        self,
        answer: Mapping[str, Any],
        found: Mapping[str, Any],
        by_pieces: Set[str],
    ) -> list[str]:
        """Figures that are not what is said, and claims that they do not bear out."""
        options, faults, claims = self.options, [], _claim(answer)
        most_outside = options.clearance_tolerance
        for name, unit, most in (
            ("position_error", "m", np.inf),  # what is claimed of errors, goals say
            ("rotation_error", "rad", np.inf),
            ("limit_violation", "rad or m", 0.0),
            ("balance_violation", "m", most_outside),
        ):
            title = name.replace("_", " ")
            if found[name] is None:
                continue
            if claims and found[name] > most + ROUNDING:
                faults.append(
                    f"claims {claims}, but {title} is {found[name]:.4g} {unit}, allowed {most:g}"
                )
            if abs(found[name] - answer[name]) > ROUNDING * (1.0 + abs(found[name])):
                faults.append(f"says {title} is {answer[name]:.9g} {unit}; it is {found[name]:.9g}")
        for name, beyond in (("clearance", "room"), ("self_distance", "self_room")):
            distance, said, title = found[name], answer[name], name.replace("_", " ")
            if distance is None:
                continue
            if claims and found[beyond] < -options.clearance_tolerance - ROUNDING:
                faults.append(
                    f"claims {claims}, but {title} is {distance:.4g} m, and of two things"
                    f" {-found[beyond]:.4g} m less than wanted"
                )
            reported = _reported_up_to(answer, options)  # and more as that
            far = min(distance, said) >= reported - ROUNDING
            near = np.isclose(said, distance, rtol=ROUNDING, atol=ROUNDING)
            more = name in by_pieces and said > distance
            both_off = min(distance, said) > ROUNDING  # depth can be measured in several ways
            if (both_off and not far and not near and not more) or (
                max(distance, said) > ROUNDING and min(distance, said) < -ROUNDING
            ):
                faults.append(f"says {title} is {said:.9g} m; it is {distance:.9g}")
        return faults

    def _unlocked(self, answer: Mapping[str, Any], call: Call) -> list[str]:
        """Joints that were to keep a position and are elsewhere."""
        at = dict(zip(self.robot.joint_names, answer["q"], strict=True))
        return [
            f"{joint} was to stay at {position:.9g}; it is at {at[joint]:.9g}"
            for joint, position in call.lock.items()
            if joint in at and abs(at[joint] - position) > ROUNDING
        ]

    def _clearance(
        self, poses: Mapping[str, FloatArray], obstacles: Obstacles
    ) -> tuple[float, float, bool] | None:
        """Least over hulls and obstacles, and beyond what is wanted of the two [m].

        And whether pieces said so, for one capsule after the other: a solver asks them for several
        at once, and may find more room. None where it is none of this judge's.
        """
        if any(what.startswith(("clearance", "what links")) for what in self.unjudged):
            return None
        least, room, by_pieces = np.inf, np.inf, False
        own_to: dict[tuple[str, int], float] = {}  # of links themselves to shapes
        for link_a, a, link_b, b, size, swept in self._hulls:
            A, B = (poses[link] @ [*p, 1.0] for link, p in ((link_a, a), (link_b, b)))
            links = sorted({link_a, link_b})
            wanted = self._wanted.of(links, ["points"], self.options.clearance)
            if wanted > -np.inf:
                far = max(least, room + wanted)
                near = to_hull(obstacles.points, A[:3], B[:3], size, swept, far)
                if near < wanted and link_a in self._own:
                    balls = obstacles.points
                    apart = to_capsule(balls[:, :3], A[:3], B[:3], size) - balls[:, 3]
                    own = self._own.to_balls(link_a, poses, balls[apart < wanted], wanted)
                    near = min(max(near, own), float(apart[apart >= wanted].min(initial=np.inf)))
                    by_pieces = True
                least, room = min(least, near), min(room, near - wanted)
            for n, shape in enumerate(obstacles.shapes):
                if not swept and not (link_a == link_b and np.array_equal(a, b)):
                    return None
                wanted = self._wanted.of(links, [shape.name], self.options.clearance)
                if wanted > -np.inf:
                    far = max(least, room + wanted)
                    near = segment_to_shape(A[:3], B[:3], shape, far + size) - size
                    if near < wanted and link_a in self._own:
                        if shape.kind == "distance_field":
                            if _OF_FIELDS not in self.unjudged:
                                self.unjudged += (_OF_FIELDS,)
                            return None
                        by_pieces, pair = True, (link_a, n)
                        if pair not in own_to:  # for each of its capsules the same
                            own_to[pair] = self._own.to_shape(link_a, poses, shape, wanted)
                        near = max(near, own_to[pair])
                    least, room = min(least, near), min(room, near - wanted)
        return least, room, by_pieces


def _reported_up_to(answer: Mapping[str, Any], options: Options) -> float:
    """How far an answer's clearance is reported [m]."""
    return max(0.5 if "tracking" in answer else options.report_clearance, options.clearance)


def _claim(answer: Mapping[str, Any]) -> str:
    """What an answer claims to be, in words; '' for nothing."""
    if "tracking" in answer:
        return "success" if answer["tracking"] == "tracking" else ""
    nearest = "all but orientation" if answer["status"] == "nearest" else ""
    return "success" if answer["success"] else nearest


def _false_claims(
    answer: Mapping[str, Any], errors: list[tuple[Requirement, float, float]]
) -> list[str]:
    """Faults: of errors beyond what goals allow, the largest of each kind."""
    claims, faults = _claim(answer), []
    if not claims:
        return []
    positions = [(error, goal.position_tolerance, goal.link) for goal, error, _ in errors]
    rotations = [
        (error, goal.rotation_tolerance, goal.link)
        for goal, _, error in errors
        if claims == "success" or not goal.position_first
    ]
    for title, unit, found in (("position", "m", positions), ("rotation", "rad", rotations)):
        error, most, link = max(found, key=lambda f: f[0] - f[1], default=(0.0, 0.0, ""))
        if error > most + ROUNDING:
            of = f" of {link}" if len(errors) > 1 else ""
            faults.append(
                f"claims {claims}, but {title} error{of} is {error:.4g} {unit}, allowed {most:g}"
            )
    return faults
