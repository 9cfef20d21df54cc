"""The control loop: a Tracker asked each millisecond, and what it answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.humanoid.dodge import problem
from bench.humanoid.dodge.plan import Plan
from bench.humanoid.world.robot import Setup, robot_in_world

PERIOD = 0.001  # [s]
SPEED_SHARE = 0.9  # of the joints' speed limits that commands may use
POSTURE_WEIGHT = 1e-2
REACT_CLEARANCE = 0.03  # [m]


class Steps:
    """What a Tracker answered, S steps.

    Args:
        time: When it was asked, (S,) [s].
        answers: Its own results.
        largest_jump: Of a step's share of its limit, at most 1.
    """

    def __init__(self, time: Sequence[float], answers: Sequence[Any], largest_jump: float) -> None:
        self.time = np.array(time)
        self.answers = answers
        self.largest_jump = largest_jump

    def column(self, name: str) -> Any:
        """One property of all answers, (S,)."""
        return np.array([getattr(answer, name) for answer in self.answers])

    @property
    def rate(self) -> FloatArray:
        """Answers per second, (S,) [Hz]."""
        return np.asarray(1.0 / self.column("time"))


class Follower:
    """Asks a Tracker for the next joint targets; `simulate` calls it.

    Args:
        setup: Where the feet are.
        q0: Where it starts, (19,).
        plan: What to follow (`predict`). None: stay near q0 and keep off the current cloud
            (`react`).
    """

    def __init__(self, setup: Setup, q0: FloatArray, plan: Plan | None = None) -> None:
        clearance = 0.0 if plan else REACT_CLEARANCE
        solver = pdoik.Solver(robot_in_world(setup), problem.options(setup, clearance=clearance))
        self.tracker = pdoik.Tracker(
            solver, PERIOD, speed_share=SPEED_SHARE, posture_weight=POSTURE_WEIGHT
        )
        self.tracker.reset(q0)
        self.tracker.set_posture(q0)
        self._goal = problem.foot_goal(setup)
        self._plan = plan
        self._limit = PERIOD * SPEED_SHARE * solver.robot.velocity
        self._q0 = np.array(q0)
        self._times: list[float] = []
        self._answers: list[Any] = []

    def __call__(self, t: float, _q: FloatArray, cloud: FloatArray) -> FloatArray:
        """The next targets, (19,), for the object's cloud at time t [s]."""
        if self._plan is not None:
            self.tracker.set_posture(self._plan.posture(t + PERIOD))
        answer = self.tracker.step(self._goal, obstacles=cloud)
        self._times.append(t)
        self._answers.append(answer)
        return np.asarray(answer.q)

    def steps(self) -> Steps:
        """What it answered so far."""
        path = np.array([self._q0, *(answer.q for answer in self._answers)])
        jumps = np.abs(np.diff(path, axis=0)) / self._limit
        return Steps(self._times, self._answers, float(jumps.max(initial=0.0)))
