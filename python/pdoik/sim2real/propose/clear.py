"""Whether a motion keeps off obstacles and off the robot itself, by pdoik's solver and tracker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import pdoik
from pdoik.recordings import FloatArray

from .path import STEP, Path, path_of

_SAMPLES = 2e-3  # between two configurations that are judged at the end [s]
_LOOK = 0.05  # between two that are looked at in the search [s]
_TRACK = 0.05  # period of the tracker that leads a path around obstacles [s]
_TRACK_TIME = 0.02  # of a step of it [s]
_POSTURE = 0.05  # of the squared distance to the path's own posture [m^2/rad^2]


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The nearest that a motion comes."""

    clearance: float  # to obstacles [m]; inf without any
    self_distance: float  # between the robot's own hulls [m]; inf where that is not judged
    room: float  # of either, what the least is beyond what is wanted of its pair [m]
    worst: str  # what is nearest, in words
    time: float  # when [s]

    def short(self, margin: float = 0.0) -> bool:
        """Whether it comes nearer than is wanted."""
        return self.room < margin


class Clear:
    """A robot with hulls among obstacles."""

    def __init__(
        self,
        robot: pdoik.Robot,
        joints: Sequence[str],
        obstacles: Any = None,
        options: pdoik.Options | None = None,
    ) -> None:
        """Joints of the robot that are none of the study's are held at zero, or near it.

        Raises:
            ValueError: the robot has no hulls, or lacks a joint of the study.
        """
        if not len(robot.occupancy):
            raise ValueError("the robot has no hulls: make some with pdoik occupancy")
        missing = [joint for joint in joints if joint not in robot.joint_names]
        if missing:
            raise ValueError(
                f"the robot with hulls has no joint {missing[0]}: expected one of"
                f" {', '.join(robot.joint_names)}"
            )
        self.robot, self.obstacles = robot, obstacles
        self.options = options or pdoik.Options(base_collision=False)
        self.solver = pdoik.Solver(robot, self.options)
        self._at = np.array([robot.joint_names.index(joint) for joint in joints])
        self._rest = np.clip(np.zeros(robot.dof), robot.lower, robot.upper)

    @property
    def keeps_off_itself(self) -> bool:
        """Whether the robot's own links are judged."""
        return bool(self.solver.judge(*self._goal(self._rest)).self_distance < np.inf)

    def at(self, q: FloatArray) -> Verdict:
        """Verdict of one configuration of the study's joints, (n,)."""
        return self._at_time(q, 0.0)

    def along(self, path: Path, period: float = _SAMPLES) -> Verdict:
        """The nearest of dense samples of a path."""
        times = np.append(np.arange(0.0, path.duration, period), path.duration)
        return self._nearest(path.curve(times), times)

    def travel(self, path: Path, period: float = _SAMPLES) -> float:
        """How far a link's origin moves between two samples at most [m].

        A hull's point may move as far again; half of it is what two clear samples may hide.
        """
        fastest = float(np.max(np.linalg.norm(path.dq, axis=1)))
        rows = path.q[:: max(1, round(_LOOK / STEP))]
        speed = path.dq[:: max(1, round(_LOOK / STEP))]
        links = list(self.robot.link_names)
        most = 0.0
        for q, dq in zip(rows, speed, strict=True):
            whole, rates = self._whole(q), np.zeros(self.robot.dof)
            rates[self._at] = dq
            for link in links[-3:]:
                most = max(
                    most, float(np.linalg.norm((self.robot.jacobian(whole, link) @ rates)[:3]))
                )
        return (most + 0.1 * fastest) * period

    def fitted(self, path: Path, start: FloatArray) -> Path:
        """A path that is clear at its samples: led around, or shrunk towards the start.

        Args:
            path: of the study's joints.
            start: (n,) a clear configuration.
        """
        if not self.is_near(path):
            return path
        led = self._led(path)
        if not self.is_near(led):
            return led
        low, high = 0.0, 1.0
        for _ in range(5):
            middle = 0.5 * (low + high)
            near = self.is_near(path.toward(start, middle))
            low, high = (low, middle) if near else (middle, high)
        return path.toward(start, low)

    def is_near(self, path: Path) -> bool:
        """Whether a path comes nearer than is wanted, at samples."""
        every = max(1, round(_LOOK / STEP))
        margin = 0.5 * self.travel(path, _LOOK)
        return self._nearest(path.q[::every], path.time[::every]).short(margin)

    def _led(self, path: Path) -> Path:
        """The tracker's answers where it follows the path's poses and postures."""
        tracker = pdoik.Tracker(
            self.solver, period=_TRACK, max_time=_TRACK_TIME, posture_weight=_POSTURE
        )
        every = round(_TRACK / STEP)
        tracker.reset(self._whole(path.q[0]))
        found = [path.q[0]]
        for row in path.q[every::every]:
            whole = self._whole(row)
            tracker.set_posture(whole)
            pose = self.robot.fk(whole, self.robot.tip_links[0])
            goal = pdoik.Goal(pose, type="position")
            answer = tracker.step(goal, obstacles=self.obstacles)
            found.append(np.asarray(answer.q)[self._at])
        times = _TRACK * np.arange(len(found))
        rows = np.stack(
            [np.interp(path.time, times, column) for column in np.array(found).T], axis=1
        )
        rows[-1] = path.q[-1]
        return path_of(rows)

    def _nearest(self, rows: FloatArray, times: FloatArray) -> Verdict:
        verdicts = [self._at_time(q, float(t)) for q, t in zip(rows, times, strict=True)]
        clearance = min(each.clearance for each in verdicts)
        apart = min(each.self_distance for each in verdicts)
        worst = min(verdicts, key=lambda each: each.room)
        return Verdict(
            clearance=clearance,
            self_distance=apart,
            room=worst.room,
            worst=worst.worst,
            time=worst.time,
        )

    def _at_time(self, q: FloatArray, time: float) -> Verdict:
        result = self.solver.judge(*self._goal(self._whole(q)), obstacles=self.obstacles)
        return Verdict(
            clearance=float(result.clearance),
            self_distance=float(result.self_distance),
            room=min(float(result.room), float(result.self_room)),
            worst=result.worst_constraint,
            time=time,
        )

    def _goal(self, whole: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self.robot.fk(whole, self.robot.tip_links[0]), whole

    def _whole(self, q: FloatArray) -> FloatArray:
        whole = self._rest.copy()
        whole[self._at] = q
        return whole
