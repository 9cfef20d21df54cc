"""The live solving session: wishes come in from anywhere, one thread grants the latest."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, cast, get_args

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.scenes.pieces import AllowedContact

from .humanoid import first_posture, is_h1
from .obstacles import Ball, Obstacles
from .shapes import moved_shape

FloatArray = npt.NDArray[np.float64]
Origin = Literal["target", "joints", "log"]
GoalKind = Literal["pose", "axis", "position", "free"]

GOALS: tuple[GoalKind, ...] = get_args(GoalKind)
_NEEDS = {"pose": 6, "axis": 5}  # joints
_DRAGGED_WEIGHT = 0.05  # against the other tips' 1: where not all can be had, they hold
_ANYWHERE = [1e3, 1e3, 1e3]  # [m]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shown:
    """What there is to show after a wish was granted."""

    robot: pdoik.Robot
    q: FloatArray  # (n,), the posture
    targets: dict[str, FloatArray]  # T_base_tip (4, 4) of each tip link
    goals: dict[str, GoalKind]  # of each tip link; a free one's target is where it is
    options: pdoik.Options  # of the solver
    result: pdoik.Result  # of q: the solver's, or its judge's where q was given
    found: pdoik.Result  # what the search said: `result`, unless it went far and found nothing
    obstacles: FloatArray  # (K, 4), points kept off, base frame; the ball is the last row [m]
    cloud: Obstacles  # what they were made from, and the shapes
    origin: Origin  # what the wish was for


class Session:
    """A robot, where its tips are wanted, and what is in the way.

    Setters only note a wish and return at once, whatever thread they are called from; `solve_once`
    grants the latest one and forgets those it replaced. One thread at a time may call `solve_once`.

    Args:
        robot: Has a target for each of its tip links.
        options: Of the solver.
        q0: First posture, (n,); None for the middle of the ranges, or the H1's stance.
        obstacles: What is in the way; None for nothing.
        goals: What is asked of each tip; None for the options' goal where the tip has the joints
            for it, otherwise its position.

    Raises:
        ValueError: An option is out of range, or the solver refuses the robot.
    """

    def __init__(
        self,
        robot: pdoik.Robot,
        options: pdoik.Options | None = None,
        q0: FloatArray | None = None,
        obstacles: Obstacles | None = None,
        goals: Mapping[str, GoalKind] | None = None,
    ) -> None:
        self.robot = robot
        self._lock = threading.Lock()
        self._options = options if options is not None else pdoik.Options()
        self._solver = _Follower(robot, self._options)
        self._goals = default_goals(robot, self._options.goal) if goals is None else dict(goals)
        self._dragged: str | None = None
        self._q = first_posture(robot) if q0 is None else _configuration(q0, robot)
        self._origin: Origin = "joints"  # of the latest wish; if not "target", _q is the wish
        self._targets = self._tip_poses(self._q)
        self._obstacles = obstacles if obstacles is not None else Obstacles()
        self._thinned: list[tuple[Obstacles, FloatArray]] = []  # the last two
        self._wish = 1  # counts wishes
        self._granted = 0

    @property
    def q(self) -> FloatArray:
        """The posture that is shown, or about to be, (n,)."""
        with self._lock:
            return self._q.copy()

    @property
    def options(self) -> pdoik.Options:
        with self._lock:
            return self._options

    @property
    def obstacles(self) -> Obstacles:
        with self._lock:
            return self._obstacles

    @property
    def targets(self) -> dict[str, FloatArray]:
        """T_base_tip of each tip link, as wished for last."""
        with self._lock:
            return {tip: T.copy() for tip, T in self._targets.items()}

    @property
    def goals(self) -> dict[str, GoalKind]:
        """What is asked of each tip link."""
        with self._lock:
            return dict(self._goals)

    def set_goal(self, tip: str, kind: GoalKind) -> None:
        """Ask for a tip's pose, axis or position where it is now, or let it go free.

        Raises:
            ValueError: The robot has no such tip, or there is no such kind.
        """
        if kind not in GOALS:
            raise ValueError(f"goal of {tip}: expected one of {', '.join(GOALS)}; got {kind!r}")
        with self._lock:
            self._check_tip(tip)
            if "free" in (kind, self._goals[tip]):
                self._targets = self._targets | {tip: self.robot.fk(self._q, tip)}
            self._goals = self._goals | {tip: kind}
            self._origin = "target"
            self._wish += 1

    def set_target(self, tip: str, T_base_tip: npt.ArrayLike) -> None:
        """Wish for a tip's pose; the other tips keep theirs.

        Raises:
            ValueError: The robot has no such tip, or the pose is not a finite 4x4 matrix.
        """
        T = np.array(T_base_tip, dtype=np.float64)
        if T.shape != (4, 4) or not np.isfinite(T).all():
            raise ValueError(f"target of {tip}: expected a finite (4, 4) matrix, got {T.tolist()}")
        with self._lock:
            self._check_tip(tip)
            self._targets = self._targets | {tip: T}
            self._dragged = tip
            self._origin = "target"
            self._wish += 1

    def set_posture(self, q: npt.ArrayLike, origin: Literal["joints", "log"] = "joints") -> None:
        """Wish for a posture; the targets jump to the tips.

        Raises:
            ValueError: Not one finite number per joint.
        """
        posture = _configuration(q, self.robot)
        with self._lock:
            self._wish_posture(posture, origin)

    def set_joint(self, index: int, position: float) -> None:
        """Wish for one joint's position [rad] or [m]; the others stay where they are."""
        with self._lock:
            posture = self._q.copy()
            posture[index] = position
            self._wish_posture(posture, "joints")

    def set_options(self, **changes: Any) -> None:
        """Change fields of the options; `goal` is then asked of every tip.

        Raises:
            TypeError, ValueError: As `pdoik.Options` and `pdoik.Solver` raise them.
        """
        options = dataclasses.replace(self.options, **changes)
        solver = _Follower(self.robot, options)
        with self._lock:
            if "goal" in changes:
                self._goals = dict.fromkeys(self._goals, options.goal)
            self._options, self._solver, self._origin = options, solver, "target"
            self._wish += 1

    def set_cloud(self, points: npt.ArrayLike | None) -> None:
        """Take another cloud, (N, 3) in the base frame [m]; None for none.

        Raises:
            ValueError: The points have another shape.
        """
        surface = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64)
        if surface.ndim != 2 or surface.shape[1] != 3:
            raise ValueError(f"points have shape {surface.shape}, expected (N, 3)")
        self._change_obstacles(surface=surface, T_base_cloud=np.eye(4))

    def set_cloud_once_thinned(self, points: npt.ArrayLike) -> int:
        """`set_cloud` after thinning it, which takes seconds for millions of points.

        Until then the robot can be moved among the obstacles there are.

        Returns:
            How many points are kept.

        Raises:
            ValueError: As `set_cloud`, or the cloud cannot be thinned so finely.
        """
        surface = np.asarray(points, dtype=np.float64)
        kept = self._thin(replace(self.obstacles, surface=surface))
        self.set_cloud(surface)
        return len(kept)

    def set_shapes(
        self, shapes: Sequence[pdoik.Shape], allowed: Sequence[AllowedContact] = ()
    ) -> None:
        """Take other shapes, and what may touch: (link, shape) or (link, shape, depth).

        Raises:
            ValueError: Two have one name, or contact is allowed with what is not there.
        """
        pdoik.Scene(shapes, allowed=allowed)
        missing = {contact[0] for contact in allowed} - set(self.robot.link_names)
        if missing:
            raise ValueError(f"allowed: {self.robot.name} has no link {min(missing)!r}")
        self._change_obstacles(shapes=tuple(shapes), allowed=tuple(allowed))

    def move_shape(self, name: str, T_base_shape: npt.ArrayLike) -> None:
        """Move the shape of that name; others stay.

        Raises:
            ValueError: It is a half-space.
        """
        T = np.array(T_base_shape, dtype=np.float64)
        with self._lock:
            shapes = tuple(
                moved_shape(each, T) if each.name == name else each
                for each in self._obstacles.shapes
            )
        self._change_obstacles(shapes=shapes)

    def set_thinning(self, leaf: float, radii: bool) -> None:
        """How the cloud is thinned, see `Obstacles`."""
        self._change_obstacles(leaf=leaf, radii=radii)

    def set_cloud_pose(self, T_base_cloud: npt.ArrayLike) -> None:
        """Move the whole cloud."""
        self._change_obstacles(T_base_cloud=np.array(T_base_cloud, dtype=np.float64))

    def set_ball(self, center: npt.ArrayLike | None, radius: float = 0.05) -> None:
        """Put the ball there [m]; None takes it away."""
        ball = None
        if center is not None:
            x, y, z = (float(value) for value in np.asarray(center, dtype=np.float64))
            ball = Ball(center=(x, y, z), radius=radius)
        self._change_obstacles(ball=ball)

    def solve_once(self) -> Shown | None:
        """Grant the latest wish; None if it has been granted.

        A target is solved for from the posture shown last, so that the robot follows. A posture
        that was wished for meanwhile is not overruled by the answer.

        Raises:
            ValueError: The cloud cannot be thinned so finely, or the solver refuses the problem.
        """
        with self._lock:
            wish, targets, obstacles = self._wish, self._targets, self._obstacles
            origin, q, solver = self._origin, self._q, self._solver
            kinds, dragged = self._goals, self._dragged
            if wish == self._granted:
                return None
            self._granted = wish  # even if it cannot be: it would fail again
        points = obstacles.placed(self._thin(obstacles))
        scene = obstacles.scene(points, self.robot)
        goals = _goals(targets, kinds, dragged)
        if origin == "target":
            result, found = solver.solve(goals, q, scene)
            q = np.asarray(result.q)
            free = {tip: self.robot.fk(q, tip) for tip, kind in kinds.items() if kind == "free"}
            with self._lock:
                if self._origin == "target":
                    self._q = q
                    still = {tip for tip in free if self._goals[tip] == "free"}
                    self._targets = self._targets | {tip: free[tip] for tip in still}
            targets = targets | free
        else:
            result = found = solver.judge(goals, q, scene)
        return Shown(
            robot=self.robot,
            q=q,
            targets=targets,
            goals=kinds,
            options=solver.options,
            result=result,
            found=found,
            obstacles=points,
            cloud=obstacles,
            origin=origin,
        )

    def _check_tip(self, tip: str) -> None:
        if tip not in self._targets:
            raise ValueError(f"{tip!r} is no tip of {self.robot.name}: {list(self._targets)}")

    def _wish_posture(self, posture: FloatArray, origin: Origin) -> None:
        self._q = posture
        self._origin = origin
        self._targets = self._tip_poses(posture)
        self._wish += 1

    def _change_obstacles(self, **changes: Any) -> None:
        with self._lock:
            self._obstacles = replace(self._obstacles, **changes)
            self._origin = "target"  # the arm gives way
            self._wish += 1

    def _tip_poses(self, q: FloatArray) -> dict[str, FloatArray]:
        return {tip: self.robot.fk(q, tip) for tip in self.robot.tip_links}

    def _thin(self, obstacles: Obstacles) -> FloatArray:
        """The thinned cloud; thinning takes longer than solving, moving the cloud does not."""
        for known, thinned in self._thinned:
            same = known.surface is obstacles.surface
            if same and (known.leaf, known.radii) == (obstacles.leaf, obstacles.radii):
                return thinned
        thinned = obstacles.thinned()
        self._thinned = [*self._thinned[-1:], (obstacles, thinned)]
        return thinned


class _Follower:
    """Looks near the posture shown last; far from it only where nothing is to be had nearby.

    Where the far search fails, too, the nearby answer stays: a robot that cannot do what it is
    asked should lean towards it, not flicker between postures.
    """

    def __init__(self, robot: pdoik.Robot, options: pdoik.Options) -> None:
        self.options = options
        # The page says so where a robot without hulls cannot keep off what it shows.
        options = replace(options, ignore_obstacles_without_hulls=True)
        self._near = pdoik.Solver(robot, replace(options, max_restarts=0))
        self._several = len(robot.tip_links) > 1  # limbs that no goal moves would drift
        far = replace(options, prefer="nearest") if self._several else options
        self._far = pdoik.Solver(robot, far)

    def solve(
        self, goals: dict[str, pdoik.Goal], q: FloatArray, scene: pdoik.Scene | FloatArray
    ) -> tuple[pdoik.Result, pdoik.Result]:
        """What to show, and what the search said."""
        posture = q if self._several and self.options.method == "default" else None
        near = self._near.solve(goals, q0=q, obstacles=scene, posture=posture)
        hopeless = near.status in ("out_of_reach", "base_collision", "blocked")
        if near.success or hopeless or self.options.method == "paper":  # which has no restarts
            return near, near
        far = self._far.solve(goals, q0=q, obstacles=scene, posture=posture)
        return (far if far.success else near), far

    def judge(
        self, goals: dict[str, pdoik.Goal], q: FloatArray, scene: pdoik.Scene | FloatArray
    ) -> pdoik.Result:
        return self._near.judge(goals, q, obstacles=scene)


def default_goals(robot: pdoik.Robot, goal: str) -> dict[str, GoalKind]:
    """The goal for tips that have the joints for it, the position for others and H1's elbows."""
    q = robot.mid_configuration()

    def kind(tip: str) -> GoalKind:
        movers = int((np.abs(robot.jacobian(q, tip)).max(axis=0) > 1e-12).sum())
        short = movers < _NEEDS.get(goal, 0)
        return "position" if short or (is_h1(robot) and "elbow" in tip) else cast(GoalKind, goal)

    return {tip: kind(tip) for tip in robot.tip_links}


def _goals(
    targets: dict[str, FloatArray], kinds: dict[str, GoalKind], dragged: str | None
) -> dict[str, pdoik.Goal]:
    """What the solver takes: goals by tip, without the free ones."""
    asked = {tip: kind for tip, kind in kinds.items() if kind != "free"}
    if not asked:  # the solver wants one: anywhere
        tip, T = next(iter(targets.items()))
        return {tip: pdoik.Goal(T, type="position", position_slack=_ANYWHERE)}
    several = len(asked) > 1
    return {
        tip: pdoik.Goal(
            targets[tip], type=kind, weight=_DRAGGED_WEIGHT if several and tip == dragged else 1.0
        )
        for tip, kind in asked.items()
    }


def _configuration(q: npt.ArrayLike, robot: pdoik.Robot) -> FloatArray:
    posture = np.array(q, dtype=np.float64)
    if posture.shape != (robot.dof,) or not np.isfinite(posture).all():
        raise ValueError(f"q: expected {robot.dof} finite numbers, got {posture.tolist()}")
    return posture
