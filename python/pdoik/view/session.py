"""The live solving session: wishes come in from anywhere, one thread grants the latest."""

from __future__ import annotations

import dataclasses
import threading
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

import pdoik

from .obstacles import Ball, Obstacles

FloatArray = npt.NDArray[np.float64]
Origin = Literal["target", "joints", "log"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shown:
    """What there is to show after a wish was granted."""

    robot: pdoik.Robot
    q: FloatArray  # (n,), the posture
    targets: dict[str, FloatArray]  # T_base_tip (4, 4) of each tip link
    result: pdoik.Result  # of the solver, or of its judge where q was given
    obstacles: FloatArray  # (K, 4), what was kept off, base frame; the ball is the last row [m]
    cloud: Obstacles  # what they were made from
    origin: Origin  # what the wish was for


class Session:
    """A robot, where its tips are wanted, and what is in the way.

    Setters only note a wish and return at once, whatever thread they are called from; `solve_once`
    grants the latest one and forgets those it replaced. One thread at a time may call `solve_once`.

    Args:
        robot: Has a target for each of its tip links.
        options: Of the solver.
        q0: First posture, (n,); None for the middle of the ranges.
        obstacles: What is in the way; None for nothing.

    Raises:
        ValueError: An option is out of range, or the solver refuses the robot.
    """

    def __init__(
        self,
        robot: pdoik.Robot,
        options: pdoik.Options | None = None,
        q0: FloatArray | None = None,
        obstacles: Obstacles | None = None,
    ) -> None:
        self.robot = robot
        self._lock = threading.Lock()
        self._options = options if options is not None else pdoik.Options()
        self._solver = pdoik.Solver(robot, self._options)
        self._q = robot.mid_configuration() if q0 is None else _configuration(q0, robot)
        self._origin: Origin = "joints"  # of the latest wish; if not "target", _q is the wish
        self._targets = self._tip_poses(self._q)
        self._obstacles = obstacles if obstacles is not None else Obstacles()
        self._thinned: tuple[tuple[int, float, bool], FloatArray] | None = None
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

    def set_target(self, tip: str, T_base_tip: npt.ArrayLike) -> None:
        """Wish for a tip's pose; the other tips keep theirs.

        Raises:
            ValueError: The robot has no such tip, or the pose is not a finite 4x4 matrix.
        """
        T = np.array(T_base_tip, dtype=np.float64)
        if T.shape != (4, 4) or not np.isfinite(T).all():
            raise ValueError(f"target of {tip}: expected a finite (4, 4) matrix, got {T.tolist()}")
        with self._lock:
            if tip not in self._targets:
                raise ValueError(f"{tip!r} is no tip of {self.robot.name}: {list(self._targets)}")
            self._targets = self._targets | {tip: T}
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
        """Change fields of the options.

        Raises:
            TypeError, ValueError: As `pdoik.Options` and `pdoik.Solver` raise them.
        """
        options = dataclasses.replace(self.options, **changes)
        solver = pdoik.Solver(self.robot, options)
        with self._lock:
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
            if wish == self._granted:
                return None
            self._granted = wish  # even if it cannot be: it would fail again
        points = obstacles.placed(self._thin(obstacles))
        if origin == "target":
            result = solver.solve(_goals(targets), q0=q, obstacles=points)
            q = np.asarray(result.q)
            with self._lock:
                if self._origin == "target":
                    self._q = q
        else:
            result = solver.judge(_goals(targets), q, obstacles=points)
        return Shown(
            robot=self.robot,
            q=q,
            targets=targets,
            result=result,
            obstacles=points,
            cloud=obstacles,
            origin=origin,
        )

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
        key = (id(obstacles.surface), obstacles.leaf, obstacles.radii)
        if self._thinned is None or self._thinned[0] != key:
            self._thinned = key, obstacles.thinned()
        return self._thinned[1]


def _goals(targets: dict[str, FloatArray]) -> Any:
    """What the solver takes: a matrix for one tip, a matrix by name for several."""
    return next(iter(targets.values())) if len(targets) == 1 else targets


def _configuration(q: npt.ArrayLike, robot: pdoik.Robot) -> FloatArray:
    posture = np.array(q, dtype=np.float64)
    if posture.shape != (robot.dof,) or not np.isfinite(posture).all():
        raise ValueError(f"q: expected {robot.dof} finite numbers, got {posture.tolist()}")
    return posture
