"""The options of a solver, with their defaults, ranges and units.

Written by python/bindings/option_fields.py from the options' headers: edit those.
"""
# ruff: noqa: RUF009  (defaults are those of C++, read once)

from collections.abc import Mapping, Sequence
from dataclasses import InitVar, dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from pdoik._option_values import DEFAULT, Axis, NestedOptions, SolverOptions, Vector3, tuples


@dataclass(frozen=True, slots=True, kw_only=True)
class LbfgsOptions(NestedOptions):
    """The limited-memory BFGS minimiser.

    Attributes:
        memory: Pairs (s, y) kept, in [1, 1000].
        max_iterations: Per minimisation, in [0, inf).
        max_line_search: Trial steps per iteration, in [1, inf).
        gradient_tolerance: Stop when the length of the gradient falls below this, in [0, inf].
        relative_decrease: Stop when f falls by less than this share of it or of what it was before,
            in [0, inf].
        first_step: Length of the first step along the steepest descent where the gradient is
            longer, in (0, inf).
        max_step: Longest first trial of an iteration, in (0, inf].
        armijo: c1 of the Wolfe conditions, in (0, 1).
        curvature: c2 of the Wolfe conditions, in (armijo, 1).

    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options.
    """

    place: ClassVar[str] = "lbfgs"
    memory: int = DEFAULT.lbfgs.memory
    max_iterations: int = DEFAULT.lbfgs.max_iterations
    max_line_search: int = DEFAULT.lbfgs.max_line_search
    gradient_tolerance: float = DEFAULT.lbfgs.gradient_tolerance
    relative_decrease: float = DEFAULT.lbfgs.relative_decrease
    first_step: float = DEFAULT.lbfgs.first_step
    max_step: float = DEFAULT.lbfgs.max_step
    armijo: float = DEFAULT.lbfgs.armijo
    curvature: float = DEFAULT.lbfgs.curvature


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedLagrangianOptions(NestedOptions):
    """Algorithm IK's outer loop (Eq. AL).

    Attributes:
        form: How constraints enter: "printed", as in the paper, has a kink at c = 0; "smooth" has
            none. Otherwise they are equal.
        rho: First penalty weight (paper: 1), in (0, inf).
        rho_growth: alpha, by which the weight grows (paper: 10), in [1, inf).
        rho_max: The weight grows no further, in [rho, inf].
        beta: Give up when max c >= beta times its last value (paper: 0.99), in (0, 1].
        constraint_tolerance: c_tol, in the constraints' own unit, in [0, inf].
        max_outer_iterations: k_max, in [1, inf).

    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options.
    """

    place: ClassVar[str] = "augmented_lagrangian"
    form: Literal["printed", "smooth"] = "smooth"
    rho: float = DEFAULT.augmented_lagrangian.rho
    rho_growth: float = DEFAULT.augmented_lagrangian.rho_growth
    rho_max: float = DEFAULT.augmented_lagrangian.rho_max
    beta: float = DEFAULT.augmented_lagrangian.beta
    constraint_tolerance: float = DEFAULT.augmented_lagrangian.constraint_tolerance
    max_outer_iterations: int = DEFAULT.augmented_lagrangian.max_outer_iterations


@dataclass(frozen=True, slots=True, kw_only=True)
class LevenbergMarquardtOptions(NestedOptions):
    """The least-squares minimiser, Levenberg and Marquardt's method.

    Attributes:
        max_iterations: Linearisations per run, in [0, inf).
        first_damping: lambda, relative to the largest diagonal entry of the Hessian, in (0, inf).
        damping_decrease: Factor after a step that went as predicted, in (0, 1].
        damping_increase: Factor after a rejected step, in (1, inf).
        max_damping: Beyond it the run has stalled, in (0, inf).
        stall_ratio: The run has stalled when `stall_window` steps leave more of f than this, in
            (0, inf].
        stall_window: See `stall_ratio`, in [1, inf).

    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options.
    """

    place: ClassVar[str] = "levenberg_marquardt"
    max_iterations: int = DEFAULT.levenberg_marquardt.max_iterations
    first_damping: float = DEFAULT.levenberg_marquardt.first_damping
    damping_decrease: float = DEFAULT.levenberg_marquardt.damping_decrease
    damping_increase: float = DEFAULT.levenberg_marquardt.damping_increase
    max_damping: float = DEFAULT.levenberg_marquardt.max_damping
    stall_ratio: float = DEFAULT.levenberg_marquardt.stall_ratio
    stall_window: int = DEFAULT.levenberg_marquardt.stall_window


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance(NestedOptions):
    """Where the centre of mass has to be (Eq. com). The base link's mass counts.

    Attributes:
        com_lower: Lower corner of a box along the base frame's axes [m]. Shape (3,).
        com_upper: Its upper corner [m]. Shape (3,).
        contacts: Points by which links stand on the ground. The centre of mass has to be over their
            convex hull, seen along `up`; empty for anywhere. By link name, shape (K, 3) in the link
            frame [m].
        support_margin: At least this far inside the hull's edges, in (-inf, inf) [m].
        up: Against gravity, in the base frame. Shape (3,).

    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options.
    """

    place: ClassVar[str] = "balance"
    com_lower: Vector3 = tuples(DEFAULT.balance.com_lower)
    com_upper: Vector3 = tuples(DEFAULT.balance.com_upper)
    contacts: Mapping[str, Sequence[Vector3] | NDArray[np.float64]] = field(
        default_factory=dict, hash=False
    )
    support_margin: float = DEFAULT.balance.support_margin
    up: Vector3 = tuples(DEFAULT.balance.up)


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch(NestedOptions):
    """Contact that is wanted at the target: a gripper at what it grasps, a flange on a surface.

    Attributes:
        radius: Obstacles that are no farther than this from a goal's target may be touched; 0 for
            none, in [0, inf) [m].
        depth: No deeper than this, of a point whatever its radius, in [0, inf] [m].
        links: Which links may touch them; empty for a tip's and those after it.

    Raises:
        ValueError: A shape is wrong. Numbers and links come out when a solver is made, and choices
            when they become part of Options.
    """

    place: ClassVar[str] = "touch"
    radius: float = DEFAULT.touch.radius
    depth: float = DEFAULT.touch.depth
    links: Sequence[str] = tuple(DEFAULT.touch.links)


@dataclass(frozen=True, slots=True, kw_only=True)
class Options(SolverOptions):
    """What a solver aims at and how. Metres, radians, seconds.

    Attributes:
        goal: What the tip has to match of targets that are bare poses: "pose" all 6 degrees of
            freedom, "axis" its position and the direction of one axis, "position" nothing but its
            position.
        goal_axis: In the tip frame, for goal "axis", of any length. A letter, "x", "y" or "z", or
            shape (3,).
        T_tip_tool: What of the tip has to be at targets that are bare poses, in the tip link's
            frame: a tool on the flange [m]. Shape (4, 4).
        priority: What comes first of targets that are bare poses where not all can be met: "both",
            nothing: position and orientation are one sum; "position", position is met, and
            orientation as near as can be: see status "nearest".
        method: Which algorithm solves: "default", restarts from a low-discrepancy sequence,
            Levenberg-Marquardt and L-BFGS inside; "paper", Algorithm IK with its misprints
            corrected, from one start. L-BFGS ends as soon as goal and constraints hold to the
            tolerances, which the paper leaves open.
        position_tolerance: Largest position error of a success, in (0, inf) [m].
        rotation_tolerance: Largest rotation (or axis) error of a success, in (0, inf) [rad].
        clearance: Least distance wanted between obstacles and hulls, or what links carry, but for
            pairs of which a ContactRule says otherwise. Negative: how deep obstacles may lie in
            hulls, of points for method "default" with inner "levenberg_marquardt". In [-1e6, 1e6]
            [m].
        clearance_tolerance: By how much a success may miss `clearance`, in [0, inf) [m].
        report_clearance: How far obstacles are looked for to report Result.clearance: beyond this
            it is reported as this, or as `clearance` where that is more. Far ones take time among
            points that change with each solve; whether an answer holds does not depend on it. In
            [0, inf] [m].
        base_collision: Whether an obstacle in a hull that no joint moves, about which no answer can
            do anything, makes a solve fail. Off for clouds that show the table the robot stands on;
            clearance is then that of the other hulls.
        exact_contact: Whether a link's own pieces decide where its capsules touch something, so
            that `success` is true of the link to their tolerance (see Occupancy.pieces); else
            capsules decide.
        ignore_obstacles_without_hulls: Whether a robot that has no hulls may be among obstacles,
            and carry something: but for what it carries nothing of it then keeps off anything. Off:
            such a robot is refused among obstacles, and steps of a Tracker hold the last answer.
        touch: What may be touched at the target, and by which links.
        balance: Where the centre of mass has to be.
        self_collision: Keep hulls of links that are not adjacent off one another, but for
            Robot.ignored_pairs; None for where that says something of the links: there are such
            pairs (a shipped robot, one with an SRDF) and the hulls are close (there are capsules).
            Not with method "paper". See `keeps_off_itself`.
        self_clearance: By at least this much, but for pairs of which a ContactRule says otherwise,
            in [-1e6, 1e6] [m].
        prefer: "first" ends with the first solution found; "nearest" spends the budget on finding
            one near the posture, or the start if none is given.
        posture_weight: Weight of the squared distance to the posture, where one is given, against
            goals and constraints, which are met first, in (0, inf) [m^2/rad^2].
        joint_weights: What each joint's distance to the posture counts relative to the others',
            shape (n,), not negative; empty for all alike. Also what "nearest" means.
        max_time: Deadline of a solve, which taking in obstacles is not part of; may be infinite.
            What the last verdicts took, but no more than half, is kept for the verdict at the end.
            In (0, inf] [s].
        max_restarts: Starts after the first; method "paper" has none, in [0, inf).
        seed: Of the restarts' sequence.
        inner: How method "default" minimises from one start: "levenberg_marquardt", Gauss-Newton
            steps in joint positions inside their limits; "lbfgs", the paper's: augmented Lagrangian
            with L-BFGS over the slack variables.
        max_obstacles: Obstacle points that fit without a further allocation, in [0, 1e7].
        rotation_weight: Metres that one radian weighs in Levenberg-Marquardt's residual; 0 for by
            the robot's size: 0.3 m where its farthest tip reaches 0.2 m to 3 m, a quarter of the
            reach of larger and smaller ones. In [0, inf) [m].
        collision_weight: Weight of a metre of penetration in Levenberg-Marquardt's residual, in
            (0, inf).
        start_inset: Starts for the slack variables keep this fraction of a range off the limits, in
            (0, 0.5).
        point_distance: k_p = q_p, where the goal's points sit on the tip's axes (Eq. vwep); 0 for
            by the robot's size: 0.5 m where `rotation_weight` is 0.3 m, and in proportion. In
            [0, inf) [m].
        lbfgs: The limited-memory BFGS minimiser.
        augmented_lagrangian: Algorithm IK's outer loop.
        levenberg_marquardt: The least-squares minimiser.

    Raises:
        TypeError: A name is unknown, or a value is of the wrong type.
        ValueError: A shape is wrong, or a str is not one of its choices. Numbers out of range come
            out when a solver is made.
    """

    goal: Literal["pose", "axis", "position"] = "pose"
    goal_axis: Axis | Vector3 = "z"
    T_tip_tool: Sequence[Sequence[float]] | NDArray[np.float64] = tuples(DEFAULT.T_tip_tool)
    priority: Literal["both", "position"] = "both"
    method: Literal["default", "paper"] = "default"
    position_tolerance: float = DEFAULT.position_tolerance
    rotation_tolerance: float = DEFAULT.rotation_tolerance
    clearance: float = DEFAULT.clearance
    clearance_tolerance: float = DEFAULT.clearance_tolerance
    report_clearance: float = DEFAULT.report_clearance
    base_collision: bool = DEFAULT.base_collision
    exact_contact: bool = DEFAULT.exact_contact
    ignore_obstacles_without_hulls: bool = DEFAULT.ignore_obstacles_without_hulls
    touch: Touch = Touch()
    balance: Balance = Balance()
    self_collision: bool | None = DEFAULT.self_collision
    self_clearance: float = DEFAULT.self_clearance
    prefer: Literal["first", "nearest"] = "first"
    posture_weight: float = DEFAULT.posture_weight
    joint_weights: Sequence[float] | NDArray[np.float64] = tuples(DEFAULT.joint_weights)
    max_time: float = DEFAULT.max_time
    max_restarts: int = DEFAULT.max_restarts
    seed: int = DEFAULT.seed
    inner: Literal["levenberg_marquardt", "lbfgs"] = "levenberg_marquardt"
    max_obstacles: int = DEFAULT.max_obstacles
    rotation_weight: float = DEFAULT.rotation_weight
    collision_weight: float = DEFAULT.collision_weight
    start_inset: float = DEFAULT.start_inset
    point_distance: float = DEFAULT.point_distance
    lbfgs: LbfgsOptions = LbfgsOptions()
    augmented_lagrangian: AugmentedLagrangianOptions = AugmentedLagrangianOptions()
    levenberg_marquardt: LevenbergMarquardtOptions = LevenbergMarquardtOptions()

    heed_fixed_hulls: InitVar[bool | None] = None  # what base_collision was called once
