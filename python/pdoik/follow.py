"""Following a planned path with a Tracker: it dodges what comes, and goes back to the path."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik.timing import Trajectory
from pdoik.tracker import Tracker

FloatArray = npt.NDArray[np.float64]


class PathFollower:
    """Steps a Tracker along a planned path.

    Each step asks for the tips' poses where the path is now, or for as much of them as the solver's
    options have as goal, with the path's joints as posture. The tracker keeps off what is in the
    way. While a tip is off the path, the path goes on more slowly: from half of max_offset on, and
    at max_offset it waits. Once the way is clear the robot is back on the path, in the
    configuration that was planned. What stays in the way is waited for without end.

    >>> import numpy as np
    >>> import pdoik
    >>> robot = pdoik.Robot.builtin("panda")
    >>> q = robot.mid_configuration() + np.linspace(0.0, 0.1, 20)[:, None]
    >>> tracker = pdoik.Tracker(pdoik.Solver(robot), period=0.01)
    >>> tracker.reset(q[0])
    >>> follower = pdoik.PathFollower(tracker, q, tool_speed=0.2)
    >>> while not follower.done:
    ...     step = follower.step()
    >>> bool(np.abs(step.q - q[-1]).max() < 1e-3)
    True

    Args:
        tracker: Reset it to where the robot is, on the path's first row or near it.
        path: A timed trajectory, or rows joined by straight lines, shape (m, n) [rad] or [m], such
            as `PathResult.q` and `MotionResult.q` have.
        tool_speed: Of the first tip, along rows [m/s]; where a joint cannot keep up, slower. A
            trajectory has its own times.
        max_offset: How far a tip may be off the path before the path waits [m].

    Attributes:
        tracker: As given.
        elapsed: Where on the path it is, in the path's own time [s].
        offset: How far the tip that is farthest was off the path after the last step [m].

    Raises:
        ValueError: A shape or number is wrong, or tool_speed is missing, or is given for a
            trajectory; a trajectory of other joints.
    """

    tracker: Final[Tracker]

    def __init__(
        self,
        tracker: Tracker,
        path: Trajectory | npt.ArrayLike,
        *,
        tool_speed: float | None = None,
        max_offset: float = 0.03,
    ) -> None:
        if not max_offset > 0:
            raise ValueError(f"max_offset is {max_offset}, expected a positive length [m]")
        robot = tracker.robot
        self.tracker, self._robot, self._max_offset = tracker, robot, max_offset
        self._tool = np.array(tracker.solver.options.T_tip_tool)
        if isinstance(path, Trajectory):
            if tool_speed is not None:
                raise ValueError("tool_speed is for rows, and a trajectory has its own times")
            if list(path.joint_names) != list(robot.joint_names):
                raise ValueError(f"the tracker's robot has joints {', '.join(robot.joint_names)}")
            self._time, self._q = path.time, path.q
        else:
            if tool_speed is None or not tool_speed > 0:
                raise ValueError(f"tool_speed is {tool_speed}, expected a positive speed [m/s]")
            self._q = _rows(path, robot.dof)
            self._time = self._times(tool_speed)
        self._moved = np.append(True, np.diff(self._time) > 0)  # for times that only rise
        self.elapsed = 0.0
        self.offset = 0.0

    @property
    def duration(self) -> float:
        """Duration of all of it, undisturbed [s]."""
        return float(self._time[-1])

    @property
    def done(self) -> bool:
        """Whether the path is at its end; the robot is there but for `offset`."""
        return self.elapsed >= self.duration

    @property
    def q(self) -> FloatArray:
        """Where the path has the joints now, shape (n,) [rad] or [m]."""
        time, q = self._time[self._moved], self._q[self._moved]
        return np.array([np.interp(self.elapsed, time, column) for column in q.T])

    def step(self, *obstacles: Any, **moving: Any) -> _core.TrackerResult:
        """One step of the tracker; then the path goes on by a period, or by less, or waits.

        Args:
            *obstacles: As in `Tracker.step`: those of the step before, if it is left out.
            **moving: The same: obstacles=, obstacle_velocity=.
        """
        q = self.q
        poses = self._poses(q)
        self.tracker.set_posture(q)
        goal = poses if len(poses) > 1 else next(iter(poses.values()))
        step = self.tracker.step(goal, *obstacles, **moving)
        self.offset = max(
            float(np.linalg.norm((there - poses[tip])[:3, 3]))
            for tip, there in self._poses(step.q).items()
        )
        share = min(max(2.0 * (1.0 - self.offset / self._max_offset), 0.0), 1.0)
        period = float(self.tracker.settings["period"])
        self.elapsed = min(self.elapsed + share * period, self.duration)
        return step

    def _poses(self, q: FloatArray) -> dict[str, FloatArray]:
        """Pose of the tool at each tip, (4, 4) each [m]."""
        return {tip: self._robot.fk(q, tip) @ self._tool for tip in self._robot.tip_links}

    def _times(self, tool_speed: float) -> FloatArray:
        """Times of the rows [s], (N,): by the tool's path length, or by the slowest joint."""
        tip = self._robot.tip_links[0]
        places = np.array([self._poses(q)[tip][:3, 3] for q in self._q])
        lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
        moved = np.abs(np.diff(self._q, axis=0))
        for name, most, length in zip(
            self._robot.joint_names, self._robot.velocity, moved.max(axis=0), strict=True
        ):
            if length > 0 and not most > 0:
                raise ValueError(f"joint {name!r} moves along the path and may not move")
        speeds = np.where(moved.max(axis=0) > 0, self._robot.velocity, 1.0)
        turns = (moved / speeds).max(axis=1)
        return np.append(0.0, np.cumsum(np.maximum(lengths / tool_speed, turns)))

    def __repr__(self) -> str:
        return f"<PathFollower at {self.elapsed:.3g} of {self.duration:.3g} s>"


def _rows(path: npt.ArrayLike, n: int) -> FloatArray:
    q = np.asarray(path, dtype=np.float64)
    if q.ndim != 2 or len(q) < 2 or q.shape[1] != n:
        raise ValueError(f"path has shape {q.shape}, expected (m, {n}) with 2 rows or more")
    if not np.isfinite(q).all():
        raise ValueError("path holds NaN or infinity")
    return q
