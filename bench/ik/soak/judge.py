"""What answers are worth, by Pinocchio and the definitions; nothing of the solver's is asked."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from bench.common.arrays import BoolArray, FloatArray
from bench.ik.soak.hulls import capsules, clearance, segment_distance
from bench.ik.soak.kinematics import Kinematics, Placed
from bench.ik.soak.robots import RobotSpec, Triple

ROUNDING = 1e-9  # what two ways to compute one figure may differ by [m] or [rad]
SAMPLES = 12  # random configurations that show what moves with what
STILL = 1e-10  # a point that moves by less between them does not move [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Goals:
    """One tip's targets, one for each of B answers."""

    tip: str
    T: FloatArray  # (B, 4, 4)
    type: Literal["pose", "axis", "position"] = "pose"
    axis: Triple = (0.0, 0.0, 1.0)
    position_slack: Triple = (0.0, 0.0, 0.0)
    rotation_slack: Triple = (0.0, 0.0, 0.0)

    def __getitem__(self, k: Any) -> Self:
        return replace(self, T=self.T[k])

    @property
    def has_slack(self) -> bool:
        """Whether it leaves some room."""
        return any(self.position_slack) or any(self.rotation_slack)


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What a solution has to keep, as pdoik.Options names it [m] and [rad]."""

    position_tolerance: float = 1e-5
    rotation_tolerance: float = 1e-5
    clearance: float = 0.0
    clearance_tolerance: float = 1e-6
    base_collision: bool = True
    self_collision: bool = False
    self_clearance: float = 0.0
    balance: Mapping[str, Any] | None = None  # arguments of pdoik.Balance

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Self:
        """Make it of arguments of pdoik.Options."""
        return cls(**{name: options[name] for name in cls.__slots__ if name in options})


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdicts:
    """Verdicts on B answers, each (B,)."""

    position_error: FloatArray  # the largest over the goals, beyond slack [m]
    rotation_error: FloatArray  # [rad]
    ambiguous: BoolArray  # a rotation by pi, whose axis may be given either way
    clearance: FloatArray  # [m]
    hollow: BoolArray  # a hull held nothing, since its foci were too far apart
    self_distance: FloatArray  # [m]
    balance_violation: FloatArray  # [m]
    limits_hold: BoolArray

    def excess(self, asked: Asked) -> dict[str, FloatArray]:
        """Excess of each requirement beyond its tolerance, not positive if it holds."""
        return {
            "position": self.position_error - asked.position_tolerance,
            "rotation": self.rotation_error - asked.rotation_tolerance,
            "clearance": asked.clearance - asked.clearance_tolerance - self.clearance,
            "self": asked.self_clearance - asked.clearance_tolerance - self.self_distance,
            "balance": self.balance_violation - asked.clearance_tolerance,
        }

    def worst(self, asked: Asked, claimed: BoolArray) -> dict[str, float]:
        """The most that any claimed answer is beyond each tolerance."""
        return {
            f"excess_{name}": float(values[claimed].max(initial=-np.inf))
            for name, values in self.excess(asked).items()
        }

    def solves(self, asked: Asked) -> BoolArray:
        """Whether all hold, the limits exactly and the rest up to rounding."""
        holds = self.limits_hold.copy()
        for excess in self.excess(asked).values():
            holds &= excess <= ROUNDING
        return holds


class Judge:
    """Judges answers of one robot; q's entries are in the order of `joint_names`."""

    def __init__(self, spec: RobotSpec, joint_names: Sequence[str]) -> None:
        self.kinematics = Kinematics(spec, joint_names)
        wide = [(link, xyz, link, xyz, r) for link, xyz, r in spec.spheres] + list(spec.spheroids)
        closer = {link for link, *_ in spec.capsules}  # what a link with capsules fills is these
        wide = [end for end in wide if not closer & {end[0], end[2]}]
        ends = wide + [(link, p, link, q, r) for link, p, q, r, _ in spec.capsules]
        self.swept = np.arange(len(ends)) >= len(wide)  # which are capsules
        self.A = np.array([end[4] for end in ends])
        self._ends = [
            _Points(self.kinematics, [(end[k], end[k + 1]) for end in ends]) for k in (0, 2)
        ]
        self.links = [(end[0], end[2]) for end in ends]
        self._probe()

    def _probe(self) -> None:
        """Find out by random configurations what stands still or goes with a tip, and pairs."""
        Q = random_configurations(self.kinematics, SAMPLES, np.random.default_rng(0))
        placed = self.kinematics.place(Q)
        a, b = (ends(placed) for ends in self._ends)
        moves = np.maximum(np.ptp(a, axis=0), np.ptp(b, axis=0)).max(axis=1, initial=0.0)
        self.fixed = moves < STILL
        foci = np.concatenate([a, b], axis=1)
        levers = np.linalg.norm(foci[:, :, None] - placed.p[:, None], axis=-1)
        self._lever = max(1.0, 1.5 * levers.max(initial=0.0))
        self.pairs = _pairs(self.kinematics, placed, a, b, self.links)

    def hulls(self, placed: Placed) -> tuple[FloatArray, FloatArray]:
        """Foci of all hulls, (B, H, 3) each."""
        return self._ends[0](placed), self._ends[1](placed)

    def __call__(
        self, goals: Sequence[Goals], Q: FloatArray, asked: Asked, points: FloatArray | None = None
    ) -> Verdicts:
        """Judge answers (B, n) among points (N, 4), or (B, N, 4) for each: centres and radii."""
        count = len(Q)
        finite = np.isfinite(Q).all(axis=1)
        Q = np.where(finite[:, None], Q, 0.0)  # of the others it is said that limits do not hold
        placed = self.kinematics.place(Q, com=asked.balance is not None)
        errors = [_goal_errors(goal, *self.kinematics.link(placed, goal.tip)) for goal in goals]
        position, rotation, ambiguous = (np.max(each, axis=0) for each in zip(*errors, strict=True))
        clear, own = np.full((2, count), np.inf)
        hollow = np.zeros(count, dtype=bool)
        among = points is not None and points.size > 0
        if len(self.A) and (asked.self_collision or among):
            a, b = self.hulls(placed)
            empty = np.linalg.norm(b - a, axis=2) >= 2 * self.A * (1 - 1e-12)
            hollow = (empty & ~self.swept).any(axis=1)
            if among:
                clear = self.clearance(a, b, points, asked)
            if asked.self_collision:
                own = self.self_distance(a, b)
        return Verdicts(
            position_error=position,
            rotation_error=rotation,
            ambiguous=ambiguous,
            clearance=clear,
            hollow=hollow,
            self_distance=own,
            balance_violation=self._balance(asked.balance, placed),
            limits_hold=self.kinematics.limits_hold(Q) & finite,
        )

    def clearance(
        self, a: FloatArray, b: FloatArray, points: FloatArray, asked: Asked
    ) -> FloatArray:
        """Clearance of the hulls that count, (B,) [m]."""
        counted = np.full(len(self.A), True) if asked.base_collision else ~self.fixed
        radii = self.A[counted]
        return clearance(a[:, counted], b[:, counted], radii, points, self.swept[counted])

    def travel(self, moved: FloatArray) -> FloatArray:
        """How far hulls may get when joints move by (B, n), roughly, (B,) [m]."""
        joints = self.kinematics.joints.values()
        turned = sum(abs(joint.multiplier) * np.abs(moved[:, joint.index]) for joint in joints)
        return np.asarray(self._lever * turned)

    def self_distance(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Least distance between the capsules around hulls that may touch, (B,) [m]."""
        if len(self.pairs) == 0:
            return np.full(len(a), np.inf)
        p, q, radius = capsules(a, b, self.A, self.swept)
        i, j = self.pairs.T
        apart = segment_distance(p[:, i], q[:, i], p[:, j], q[:, j]) - radius[:, i] - radius[:, j]
        least: FloatArray = np.where(np.isnan(apart), np.inf, apart).min(axis=1)
        return least

    def _balance(self, balance: Mapping[str, Any] | None, placed: Placed) -> FloatArray:
        """How far the centre of mass is outside its box and its polygon, 0 inside, (B,) [m]."""
        outside, com = np.zeros(len(placed.p)), placed.com
        if balance is None:
            return outside
        lower, upper = (balance.get(f"com_{end}") for end in ("lower", "upper"))
        if lower is not None:
            outside = np.maximum(outside, (np.asarray(lower) - com).max(axis=1))
        if upper is not None:
            outside = np.maximum(outside, (com - np.asarray(upper)).max(axis=1))
        if contacts := balance.get("contacts"):
            at = [(link, tuple(xyz)) for link, points in contacts.items() for xyz in points]
            corners = _Points(self.kinematics, at)(placed)
            up = np.asarray(balance.get("up", [0.0, 0.0, 1.0]))
            margin = balance.get("support_margin", 0.0)
            outside = np.maximum(outside, beyond_polygon(corners, com, up) + margin)
        return outside


def beyond_polygon(corners: FloatArray, point: FloatArray, up: FloatArray) -> FloatArray:
    """How far points (B, 3) lie beyond the convex hull of corners (B, K, 3), seen along `up`.

    Negative inside. The hull's edges are the lines through two corners that have all others on one
    side.
    """
    up = up / np.linalg.norm(up)
    side = np.cross(up, np.eye(3)[np.abs(up).argmin()])
    side /= np.linalg.norm(side)
    axes = np.stack([side, np.cross(up, side)], axis=1)
    flat, at = corners @ axes, point @ axes
    edges = flat[:, None] - flat[:, :, None]  # [b, i, j]: from i to j
    lengths = np.linalg.norm(edges, axis=-1)
    outward = np.stack([edges[..., 1], -edges[..., 0]], axis=-1)
    outward /= np.where(lengths > 1e-9, lengths, np.inf)[..., None]
    heights = np.einsum("bijx,bikx->bijk", outward, edges)  # of corner k over the line i to j
    is_edge = (lengths > 1e-9) & (heights.max(axis=-1) <= 1e-12)
    over = np.einsum("bijx,bix->bij", outward, at[:, None] - flat)
    return np.asarray(np.where(is_edge, over, -np.inf).max(axis=(1, 2)))


class _Points:
    """Points fixed to links, wherever these are."""

    def __init__(
        self, kinematics: Kinematics, points: Sequence[tuple[str, tuple[float, ...]]]
    ) -> None:
        seats = [(*kinematics.seat(link), np.array(xyz)) for link, xyz in points]
        self._joints = np.array([joint for joint, *_ in seats], dtype=np.intp)
        self._local = np.array([R @ xyz + p for _, R, p, xyz in seats]).reshape(-1, 3)

    def __call__(self, placed: Placed) -> FloatArray:
        turned = np.einsum("bkij,kj->bki", placed.R[:, self._joints], self._local)
        return np.asarray(turned + placed.p[:, self._joints])


def _goal_errors(
    goal: Goals, R: FloatArray, p: FloatArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Position and rotation error beyond slack, and where the latter's axis is unclear."""
    off = p - goal.T[:, :3, 3]
    position = np.linalg.norm(off, axis=1)
    R_target = goal.T[:, :3, :3]
    if any(goal.position_slack):
        along = np.abs(np.einsum("bji,bj->bi", R_target, off)) - goal.position_slack
        position = np.linalg.norm(np.maximum(along, 0.0), axis=1)
    unclear = np.zeros(len(p), dtype=bool)
    if goal.type == "position":
        return position, np.zeros(len(p)), unclear
    if goal.type == "axis":
        is_at, wanted = R @ np.array(goal.axis), R_target @ np.array(goal.axis)
        sine = np.linalg.norm(np.cross(is_at, wanted), axis=1)
        angle = np.arctan2(sine, np.einsum("bi,bi->b", is_at, wanted))
        return position, np.maximum(angle - max(goal.rotation_slack), 0.0), unclear
    turn = Rotation.from_matrix(R_target.swapaxes(1, 2) @ R).as_rotvec()
    angle = np.linalg.norm(turn, axis=1)
    if any(goal.rotation_slack):
        unclear = angle > np.pi - 1e-6
        angle = np.linalg.norm(np.maximum(np.abs(turn) - goal.rotation_slack, 0.0), axis=1)
    return position, angle, unclear


def random_configurations(
    kinematics: Kinematics, count: int, rng: np.random.Generator
) -> FloatArray:
    """Uniform within the limits, or within half a turn or metre where there are none, (B, n)."""
    lower = np.where(np.isfinite(kinematics.lower), kinematics.lower, -np.pi)
    upper = np.where(np.isfinite(kinematics.upper), kinematics.upper, np.pi)
    Q = rng.uniform(lower, upper, (count, len(lower)))
    return np.asarray(kinematics.into_limits(Q))


def _pairs(
    kinematics: Kinematics,
    placed: Placed,
    a: FloatArray,
    b: FloatArray,
    links: Sequence[tuple[str, str]],
) -> npt.NDArray[np.intp]:
    """Hulls between which distances count, (P, 2).

    Left out are those on the same link or on links that are joined, through any number of fixed
    joints; those that stay where they are relative to each other; and the robot's ignored pairs.
    A focus moves with its own link and, as long as it lies on the axes of the joints between, with
    those before it. A hull both of whose foci move with one link is on that link, the farthest from
    the base of them; any other is on the two links that it was given on.
    """
    parents = list(kinematics.model.parents)
    neighbours: dict[int, set[int]] = {j: set() for j in range(len(parents))}
    for joint, parent in enumerate(parents[1:], start=1):
        neighbours[joint].add(parent)
        neighbours[parent].add(joint)
    root = kinematics.base[0]
    towards_base, queue = {root: root}, [root]  # of each joint the next one on the way
    while queue:
        at = queue.pop()
        for other in neighbours[at] - towards_base.keys():
            towards_base[other] = at
            queue.append(other)

    def moved_by(link: str, focus: FloatArray) -> list[int]:
        """The joints on the way to the base whose links a focus moves with, its own first."""
        joints, joint = [], kinematics.seat(link)[0]
        while not joints or joint != joints[-1]:
            local = np.einsum("bji,bj->bi", placed.R[:, joint], focus - placed.p[:, joint])
            if np.ptp(local, axis=0).max() > STILL:
                break
            joints.append(joint)
            joint = towards_base[joint]
        return joints

    seats = []
    for hull, (first, second) in enumerate(links):
        ways = moved_by(first, a[:, hull]), moved_by(second, b[:, hull])
        both = [joint for joint in ways[0] if joint in ways[1]]
        on = {both[0]} if both else {ways[0][0], ways[1][0]}
        named = {link for link in (first, second) if kinematics.seat(link)[0] in on}
        seats.append((on, named, set(both)))
    ignored = {frozenset(pair) for pair in kinematics.spec.ignored_pairs}
    pairs = []
    for i, (joints_i, links_i, parts_i) in enumerate(seats):
        for j, (joints_j, links_j, parts_j) in enumerate(seats[:i]):
            near = any(x == y or y in neighbours[x] for x in joints_i for y in joints_j)
            free = any(frozenset((x, y)) in ignored for x in links_i for y in links_j)
            if not (near or free or parts_i & parts_j):
                pairs.append((j, i))
    return np.array(pairs, dtype=np.intp).reshape(-1, 2)
