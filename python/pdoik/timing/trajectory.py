"""A motion in time, its files, and a second look at whether it is clear."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik._files import write_whole
from pdoik.errors import LoadError

if TYPE_CHECKING:
    from pdoik.solver import Solver

FloatArray = npt.NDArray[np.float64]

Limit = Literal["speed", "acceleration", "jerk", "turn", "resolution"]

_DERIVATIVES = ("q", "dq", "ddq")


@dataclass(frozen=True, slots=True, kw_only=True)
class Dip:
    """Where the tool is slower than asked for, and what keeps it from being faster.

    Speeding up after a rest and braking before one are no dips.
    """

    start: float  # [s]
    end: float  # [s]
    start_at: float  # place on the path, see Trajectory.at
    end_at: float
    speed: float  # of the tool, the least of it [m/s]
    limit: Limit  # that binds there; turn: tool_turn; resolution: none, but steps are too coarse
    joint: str  # whose limit it is; '' for turn and resolution


@dataclass(frozen=True, slots=True, kw_only=True)
class Recheck:
    """What a solver's judge says of a whole trajectory."""

    success: bool  # limits, clearance and all else that the solver's options ask for hold
    clearance: float  # least, infinite without obstacles or hulls [m]
    self_distance: float  # least, infinite where self-collision is not asked for [m]
    limit_violation: float  # largest [rad] or [m]
    worst: _core.Result  # where what is asked for is missed by most, or comes nearest to that
    time: float  # when that is [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """Joint positions, speeds and accelerations by time, from rest to rest.

    Raises:
        ValueError: Shapes do not belong together, or times do not rise from 0.
    """

    joint_names: tuple[str, ...]  # n
    time: FloatArray  # (k,), rising from 0 [s]
    q: FloatArray  # (k, n) [rad] or [m]
    dq: FloatArray  # (k, n), its derivative [rad/s] or [m/s]
    ddq: FloatArray  # (k, n), the next; where it jumps, what it is afterwards
    at: FloatArray  # (k,), place on the path: rows, or what time_path was given of them
    dips: tuple[Dip, ...] = ()  # where the tool is slower than asked for, in order
    deviation: float = np.nan  # largest of a joint from the rows' straight lines [rad] or [m]

    def __post_init__(self) -> None:
        """Check shapes."""
        for name in ("time", *_DERIVATIVES, "at"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=np.float64))
        k = len(self.time)
        for name in _DERIVATIVES:
            shape = getattr(self, name).shape
            if shape != (k, len(self.joint_names)):
                raise ValueError(f"{name} has shape {shape}, expected {(k, len(self.joint_names))}")
        if self.at.shape != (k,):
            raise ValueError(f"at has shape {self.at.shape}, expected {(k,)}")
        if k < 2 or self.time[0] != 0.0 or not (np.diff(self.time) > 0.0).all():
            raise ValueError("time does not rise from 0 in at least two steps")

    @property
    def duration(self) -> float:
        """Duration of all of it [s]."""
        return float(self.time[-1])

    def sample(self, t: npt.ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, dq and ddq at other times; before and after it is at rest.

        Positions are cubic between samples; speeds and accelerations are straight between them,
        so that they are never beyond those of the samples.

        Args:
            t: Any times, shape (...) [s].

        Returns:
            Three arrays of shape (..., n).
        """
        t = np.asarray(t, dtype=np.float64)
        inside = np.clip(t, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, len(self.time) - 2)
        width = (self.time[k + 1] - self.time[k])[..., None]
        w = (inside - self.time[k])[..., None] / width
        move = self.q[k + 1] - self.q[k]
        first, last = width * self.dq[k] - move, move - width * self.dq[k + 1]
        q = self.q[k] + w * move + w * (1 - w) * ((1 - w) * first + w * last)  # Hermite's cubic
        moving = ((t >= 0.0) & (t < self.duration))[..., None]
        dq = np.where(moving, (1 - w) * self.dq[k] + w * self.dq[k + 1], 0.0)
        ddq = np.where(moving, (1 - w) * self.ddq[k] + w * self.ddq[k + 1], 0.0)
        return q, dq, ddq

    def recheck(self, solver: Solver, obstacles: Any = None, max_step: float = 0.01) -> Recheck:
        """Judge it all along, by `solver.judge`: limits, clearance, self-collision, balance.

        A trajectory leaves the straight lines of its path by up to `deviation`, so what the path
        was clear of by less may be touched.

        Args:
            solver: Of the same robot, with the options that are to hold.
            obstacles: As in `solve`; a Cloud is taken in once.
            max_step: Of a joint, from one look to the next [rad] or [m].

        Raises:
            ValueError: The solver's robot has other joints, or max_step is not positive.
        """
        robot = solver.robot
        if tuple(robot.joint_names) != self.joint_names:
            raise ValueError(f"the solver's robot has joints {', '.join(robot.joint_names)}")
        if not max_step > 0.0:
            raise ValueError(f"max_step is {max_step}, expected a positive number")
        if obstacles is not None and isinstance(obstacles, np.ndarray):
            obstacles = _core.Cloud(obstacles)
        tip = robot.tip_links[0]
        results = []
        times = self._dense(max_step)
        for q in self.sample(times)[0]:
            there = {tip: robot.fk(q, tip)}  # so that no goal is missed
            results.append(solver.judge(there, q, obstacles, T_tip_tool={tip: np.eye(4)}))
        worst = int(np.argmax([each.worst_violation for each in results]))
        return Recheck(
            success=all(each.success for each in results),
            clearance=min(each.clearance for each in results),
            self_distance=min(each.self_distance for each in results),
            limit_violation=max(each.limit_violation for each in results),
            worst=results[worst],
            time=float(times[worst]),
        )

    def _dense(self, max_step: float) -> FloatArray:
        """Times between which no joint goes farther than this, as far as samples show."""
        gone = np.append(0.0, np.cumsum(np.abs(np.diff(self.q, axis=0)).max(axis=1)))
        count = int(np.ceil(gone[-1] / max_step)) + 1
        return np.interp(np.linspace(0.0, gone[-1], max(count, 2)), gone, self.time)

    def to_csv(self, path: str | Path) -> None:
        """Write what `from_csv` reads: time, at, and q.NAME, dq.NAME, ddq.NAME of each joint.

        Replaces a file only when all is written. Dips and deviation are left out.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(_columns(self.joint_names))
        writer.writerows(np.column_stack([self.time, self.at, self.q, self.dq, self.ddq]).tolist())
        write_whole(path, text.getvalue())

    @classmethod
    def from_csv(cls, path: str | Path) -> Trajectory:
        """Read what `to_csv` wrote; it then has no dips, and deviation is NaN.

        Raises:
            LoadError: The file is missing or is something else.
        """
        try:
            with Path(path).open(newline="") as file:
                header, *rows = csv.reader(file)
            names = tuple(name[2:] for name in header if name.startswith("q."))
            if header != _columns(names):
                raise ValueError("its columns are not time, at, q.NAME, dq.NAME, ddq.NAME")
            values = np.array(rows, dtype=np.float64).reshape(len(rows), -1)
            if values.shape[1] != len(header) or not np.isfinite(values).all():
                raise ValueError("a number is missing")
            time, at, rest = values[:, 0], values[:, 1], values[:, 2:]
            q, dq, ddq = np.split(rest, 3, axis=1)
            return cls(joint_names=names, time=time, q=q, dq=dq, ddq=ddq, at=at)
        except (OSError, ValueError, csv.Error) as error:
            raise LoadError(f"{path}: not a trajectory file: {error}") from error

    def to_yaml(self, path: str | Path) -> None:
        """Write it as ROS writes a trajectory_msgs/JointTrajectory, without a header.

        Replaces a file only when all is written.
        """
        lines = [f"joint_names: {json.dumps(list(self.joint_names))}", "points:"]
        names = ("positions", "velocities", "accelerations")
        for time, *states in zip(self.time, self.q, self.dq, self.ddq, strict=True):
            entry = [
                f"{name}: {_numbers(state)}" for name, state in zip(names, states, strict=True)
            ]
            seconds, nanoseconds = divmod(round(float(time) * 1e9), 10**9)
            entry.append(f"time_from_start: {{sec: {seconds}, nanosec: {nanoseconds}}}")
            lines.append("- " + "\n  ".join(entry))
        write_whole(path, "\n".join(lines) + "\n")

    def __repr__(self) -> str:
        dips = f", {len(self.dips)} dips" if self.dips else ""
        return (
            f"<Trajectory of {len(self.joint_names)} joints, {self.duration:.4g} s, "
            f"{len(self.time)} samples{dips}>"
        )


def _columns(names: tuple[str, ...]) -> list[str]:
    return ["time", "at", *(f"{kind}.{name}" for kind in _DERIVATIVES for name in names)]


def _numbers(values: FloatArray) -> str:
    return "[" + ", ".join(f"{value:.12f}" for value in values.tolist()) + "]"
