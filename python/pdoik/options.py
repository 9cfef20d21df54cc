"""The options of a solver, with their defaults and units."""

import dataclasses
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import InitVar, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pdoik import _core
from pdoik._core import Robot

Vector3 = Sequence[float] | NDArray[np.float64]
Axis = Literal["x", "y", "z"]
_DEFAULT = _core.Options()  # numbers are typed once, in cpp/include/pdoik/options.hpp
_LBFGS = _DEFAULT.lbfgs
_LAGRANGIAN = _DEFAULT.augmented_lagrangian
_LM = _DEFAULT.levenberg_marquardt
_NO_TOOL = tuple(map(tuple, _DEFAULT.T_tip_tool.tolist()))
_AXES: dict[Axis, tuple[float, float, float]] = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def _to_vector(values: Vector3, name: str) -> tuple[float, ...]:
    vector = np.asarray(values, dtype=np.float64)
    if vector.shape != (3,):
        raise ValueError(f"{name} has shape {vector.shape}, expected (3,)")
    return tuple(vector.tolist())


@dataclass(frozen=True, slots=True, kw_only=True)
class LbfgsOptions:
    """Of the limited-memory BFGS minimiser.

    Attributes:
        memory: Pairs (s, y) kept.
        max_iterations: Per minimisation.
        max_line_search: Trial steps per iteration.
        gradient_tolerance: Stop when the gradient falls below this.
        relative_decrease: Stop when f falls by less than this share of it.
        first_step: Length of the first step along the steepest descent, at most.
        max_step: Longest first trial of an iteration.
        armijo: c1 of the Wolfe conditions.
        curvature: c2 of the Wolfe conditions.
    """

    memory: int = _LBFGS.memory
    max_iterations: int = _LBFGS.max_iterations
    max_line_search: int = _LBFGS.max_line_search
    gradient_tolerance: float = _LBFGS.gradient_tolerance
    relative_decrease: float = _LBFGS.relative_decrease
    first_step: float = _LBFGS.first_step
    max_step: float = _LBFGS.max_step
    armijo: float = _LBFGS.armijo
    curvature: float = _LBFGS.curvature


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedLagrangianOptions:
    """Of Algorithm IK's outer loop (Eq. AL).

    Attributes:
        form: "printed", as in the paper, has a kink at c = 0; "smooth" has none. Otherwise equal.
        rho: First penalty weight.
        rho_growth: alpha, by which the weight grows.
        rho_max: The weight grows no further.
        beta: Give up when max c >= beta times its last value.
        constraint_tolerance: c_tol, in the constraints' own unit.
        max_outer_iterations: k_max.
    """

    form: Literal["printed", "smooth"] = "smooth"
    rho: float = _LAGRANGIAN.rho
    rho_growth: float = _LAGRANGIAN.rho_growth
    rho_max: float = _LAGRANGIAN.rho_max
    beta: float = _LAGRANGIAN.beta
    constraint_tolerance: float = _LAGRANGIAN.constraint_tolerance
    max_outer_iterations: int = _LAGRANGIAN.max_outer_iterations


@dataclass(frozen=True, slots=True, kw_only=True)
class LevenbergMarquardtOptions:
    """Of the least-squares minimiser.

    Attributes:
        max_iterations: Linearisations per run.
        first_damping: lambda, relative to the largest diagonal entry of the Hessian.
        damping_decrease: Factor after a step that went as predicted.
        damping_increase: Factor after a rejected step.
        max_damping: Beyond it the run has stalled.
        stall_ratio: The run has stalled when `stall_window` steps leave more of f than this.
        stall_window: See `stall_ratio`.
    """

    max_iterations: int = _LM.max_iterations
    first_damping: float = _LM.first_damping
    damping_decrease: float = _LM.damping_decrease
    damping_increase: float = _LM.damping_increase
    max_damping: float = _LM.max_damping
    stall_ratio: float = _LM.stall_ratio
    stall_window: int = _LM.stall_window


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """Contact that is wanted at the target: a gripper at what it grasps, a flange on a surface.

    Attributes:
        radius: Obstacles that are no farther than this from a goal's target may be touched; 0 for
            none [m].
        depth: No deeper than this, of a point whatever its radius [m].
        links: Which links may touch them; none for a tip's and those after it.

    Raises:
        ValueError: Out of range or no link: when a solver is made.
    """

    radius: float = _DEFAULT.touch.radius
    depth: float = _DEFAULT.touch.depth
    links: Sequence[str] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """Where the centre of mass has to be (Eq. com). The base link's mass counts.

    Attributes:
        com_lower: Lower corner of a box along the base frame's axes, shape (3,) [m].
        com_upper: Its upper corner, shape (3,) [m].
        contacts: Points by which links stand on the ground: by link name, shape (K, 3) in the link
            frame [m]. The centre of mass has to be over their convex hull, seen along `up`. Empty
            for anywhere.
        support_margin: At least this far inside the hull's edges [m].
        up: Against gravity, in the base frame, shape (3,).

    Raises:
        ValueError: A shape is wrong. Links and numbers come out when a solver is made.
    """

    com_lower: Vector3 = (-np.inf, -np.inf, -np.inf)
    com_upper: Vector3 = (np.inf, np.inf, np.inf)
    contacts: Mapping[str, Sequence[Vector3] | NDArray[np.float64]] = field(default_factory=dict)
    support_margin: float = _DEFAULT.balance.support_margin
    up: Vector3 = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        """Check shapes; copy what could be changed from outside."""
        for name in ("com_lower", "com_upper", "up"):
            object.__setattr__(self, name, _to_vector(getattr(self, name), f"balance.{name}"))
        contacts = {}
        for link, points in self.contacts.items():
            array = np.asarray(points, dtype=np.float64)
            if array.ndim != 2 or array.shape[1] != 3:
                raise ValueError(
                    f"balance.contacts[{link!r}] has shape {array.shape}, expected (K, 3)"
                )
            contacts[link] = [tuple(point) for point in array.tolist()]
        object.__setattr__(self, "contacts", contacts)

    def __hash__(self) -> int:
        """Of what it holds."""
        contacts = tuple((link, tuple(points)) for link, points in sorted(self.contacts.items()))
        return hash((self.com_lower, self.com_upper, contacts, self.support_margin, self.up))


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What a solver aims at and how. Metres, radians, seconds.

    Attributes:
        goal: What the tip has to match of its target: "pose" all 6 degrees of freedom, "axis" its
            position and the direction of one axis, "position" nothing else.
        goal_axis: In the tip frame, for goal "axis": a letter or a vector of any length.
        T_tip_tool: Of targets that are bare arrays: what of the tip has to be at the target, in the
            tip link's frame, shape (4, 4) [m]: a tool on the flange.
        priority: Of targets that are bare arrays: "position" meets the position first and the
            orientation as nearly as can be, with the status "nearest" where that is not all of it;
            "both" meets both or fails.
        method: "default" restarts from a low-discrepancy sequence; "paper" is Algorithm IK with its
            misprints corrected, from one start, ended as soon as the tolerances hold.
        position_tolerance: Largest position error of a success [m].
        rotation_tolerance: Largest rotation (or axis) error of a success [rad].
        clearance: Least distance wanted between obstacles and hulls, or what links carry, but for
            pairs of which a ContactRule says otherwise; negative: how deep points may lie inside,
            for method "default" with inner "levenberg_marquardt" [m].
        clearance_tolerance: By how much a success may miss `clearance` [m].
        report_clearance: How far obstacles are looked for to tell a result's clearance: beyond
            this it is told as this, or as `clearance` where that is more. Far ones take time among
            points that change with each solve; whether an answer holds does not depend on it [m].
        base_collision: Whether an obstacle in a hull that no joint moves, about which no answer
            can do anything, makes a solve fail. False for clouds that show the table the robot
            stands on; clearance is then that of the other hulls.
        exact_contact: Whether a link's own pieces decide where its capsules touch something, so
            that `success` is true of the link to their tolerance (see Occupancy.pieces); else
            capsules decide.
        ignore_obstacles_without_hulls: Whether a robot that has no hulls may be among obstacles,
            and carry something: but for what it carries nothing of it then keeps off anything.
            Else what takes obstacles raises ValueError for such a robot, and steps of a Tracker
            hold the last answer.
        touch: What may be touched at the target, and by which links.
        balance: Where the centre of mass has to be.
        self_collision: Keep hulls of links that are not adjacent off one another, but for
            Robot.ignored_pairs; None for where that says something of the links: there are such
            pairs (a shipped robot, one with an SRDF) and the hulls are close (there are
            capsules). Not with method "paper". See `keeps_off_itself`.
        self_clearance: By at least this much, but for pairs of which a ContactRule says otherwise
            [m].
        prefer: "first" ends with the first solution found; "nearest" spends the budget on finding
            one near the posture, or the start if none is given.
        posture_weight: Of the squared distance to the posture against goals and constraints, which
            are met first [m^2/rad^2].
        joint_weights: What each joint's distance to the posture counts beside the others', shape
            (n,), not negative; empty for all alike. Also what "nearest" means.
        max_time: Deadline of a solve, beside taking obstacles in [s]; may be infinite. What the
            last verdicts took, but no more than half, is kept for the verdict at the end.
        max_restarts: Starts after the first.
        seed: Of the restarts' sequence.
        inner: How method "default" minimises from one start: "levenberg_marquardt" over joint
            positions, or the paper's augmented Lagrangian with "lbfgs" over slack variables.
        max_obstacles: Obstacle points that fit without a further allocation.
        rotation_weight: Metres that one radian weighs in Levenberg-Marquardt's residual [m]; 0 for
            by the robot's size: 0.3 m where its farthest tip reaches 0.2 m to 3 m, a quarter of
            the reach of larger and smaller ones.
        collision_weight: Of a metre of penetration in Levenberg-Marquardt's residual.
        start_inset: Starts for the slack variables keep this fraction of a range off the limits.
        point_distance: k_p = q_p, where the goal's points sit on the tip's axes [m] (Eq. vwep); 0
            for by the robot's size: 0.5 m where rotation_weight is 0.3 m, and in proportion.
        lbfgs: Of the limited-memory BFGS minimiser.
        augmented_lagrangian: Of Algorithm IK's outer loop.
        levenberg_marquardt: Of the least-squares minimiser.

    Raises:
        TypeError: A name is unknown or a value is of the wrong type.
        ValueError: A str is not one of its choices. Numbers out of range come out when a solver is
            made.
    """

    goal: Literal["pose", "axis", "position"] = "pose"
    goal_axis: Axis | Vector3 = "z"
    T_tip_tool: Sequence[Sequence[float]] | NDArray[np.float64] = _NO_TOOL
    priority: Literal["both", "position"] = "both"
    method: Literal["default", "paper"] = "default"

    position_tolerance: float = _DEFAULT.position_tolerance
    rotation_tolerance: float = _DEFAULT.rotation_tolerance
    clearance: float = _DEFAULT.clearance
    clearance_tolerance: float = _DEFAULT.clearance_tolerance
    report_clearance: float = _DEFAULT.report_clearance

    base_collision: bool = _DEFAULT.base_collision
    exact_contact: bool = _DEFAULT.exact_contact
    ignore_obstacles_without_hulls: bool = _DEFAULT.ignore_obstacles_without_hulls

    touch: Touch = Touch()
    balance: Balance = Balance()
    self_collision: bool | None = None
    self_clearance: float = _DEFAULT.self_clearance

    prefer: Literal["first", "nearest"] = "first"
    posture_weight: float = _DEFAULT.posture_weight
    joint_weights: Sequence[float] | NDArray[np.float64] = ()

    max_time: float = _DEFAULT.max_time
    max_restarts: int = _DEFAULT.max_restarts
    seed: int = _DEFAULT.seed

    inner: Literal["levenberg_marquardt", "lbfgs"] = "levenberg_marquardt"
    max_obstacles: int = _DEFAULT.max_obstacles

    rotation_weight: float = _DEFAULT.rotation_weight
    collision_weight: float = _DEFAULT.collision_weight
    start_inset: float = _DEFAULT.start_inset
    point_distance: float = _DEFAULT.point_distance

    lbfgs: LbfgsOptions = LbfgsOptions()
    augmented_lagrangian: AugmentedLagrangianOptions = AugmentedLagrangianOptions()
    levenberg_marquardt: LevenbergMarquardtOptions = LevenbergMarquardtOptions()

    heed_fixed_hulls: InitVar[bool | None] = None  # what base_collision was called once

    def __post_init__(self, heed_fixed_hulls: bool | None) -> None:
        """Check types and make goal_axis hashable."""
        if heed_fixed_hulls is not None:
            warnings.warn("heed_fixed_hulls is now base_collision", DeprecationWarning, 3)
            object.__setattr__(self, "base_collision", heed_fixed_hulls)
        if not isinstance(self.goal_axis, str):
            object.__setattr__(self, "goal_axis", _to_vector(self.goal_axis, "goal_axis"))
        tool = np.asarray(self.T_tip_tool, dtype=np.float64)
        if tool.shape != (4, 4):
            raise ValueError(f"T_tip_tool has shape {tool.shape}, expected (4, 4)")
        object.__setattr__(self, "T_tip_tool", tuple(map(tuple, tool.tolist())))
        weights = np.asarray(self.joint_weights, dtype=np.float64)
        if weights.ndim != 1:
            raise ValueError(f"joint_weights has shape {weights.shape}, expected (n,)")
        object.__setattr__(self, "joint_weights", tuple(weights.tolist()))
        to_core(self)

    def keeps_off_itself(self, robot: Robot) -> bool:
        """What self_collision comes to for a robot."""
        return to_core(self).keeps_off_itself(robot)


def to_core(options: Options) -> _core.Options:
    """The C++ options with these values."""
    result = _core.Options()
    _copy(options, result)
    return result


def _copy(source: Any, target: Any) -> None:
    """Set the attributes of a C++ struct to the fields of the dataclass that mirrors it."""
    for each in dataclasses.fields(source):
        value = getattr(source, each.name)
        if each.name == "goal_axis" and isinstance(value, str):
            if value not in _AXES:
                raise ValueError(f"goal_axis is {value!r}, expected 'x', 'y', 'z' or a 3-vector")
            value = _AXES[value]
        if each.name == "T_tip_tool":
            value = np.asarray(value)
        if dataclasses.is_dataclass(each.type) and type(value) is each.type:
            _copy(value, getattr(target, each.name))
            continue
        try:
            setattr(target, each.name, value)
        except TypeError:
            what = f"{type(source).__name__}.{each.name} is {value!r}"
            expected = getattr(each.type, "__name__", each.type)
            raise TypeError(f"{what}, expected {expected}") from None
