"""The control loop: a Tracker asked each millisecond, and what it answered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import pdoik
from pdoik.h1 import problem
from pdoik.h1.dodge import Plan
from pdoik.h1.model import Setup
from pdoik.h1.robot import FloatArray

PERIOD = 0.001  # [s]
SPEED_SHARE = 0.9  # of the joints' speed limits that commands may use
POSTURE_WEIGHT = 1e-2
REACT_CLEARANCE = 0.03  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """What a Tracker answered, S steps."""

    time: FloatArray  # (S,): when it was asked [s]
    seconds: FloatArray  # (S,): how long it took [s]
    position_error: FloatArray  # (S,): of the right foot [m]
    rotation_error: FloatArray  # (S,): of the right foot [rad]
    balance_violation: FloatArray  # (S,): of the posture that was answered [m]
    clearance: FloatArray  # (S,): of the hulls [m]
    self_distance: FloatArray  # (S,) [m]
    tracking: list[str]
    worst: list[str]  # the worst constraint of each step
    largest_jump: float  # of a step's share of its limit, at most 1

    @property
    def rate(self) -> FloatArray:
        """Answers per second, (S,) [Hz]."""
        return np.asarray(1.0 / self.seconds)


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
        self._solver = pdoik.Solver(
            problem.robot_in_world(setup), problem.options(setup, clearance=clearance)
        )
        self.tracker = pdoik.Tracker(
            self._solver, PERIOD, speed_share=SPEED_SHARE, posture_weight=POSTURE_WEIGHT
        )
        self.tracker.reset(q0)
        self.tracker.set_posture(q0)
        self._goal = problem.foot_goal(setup)
        self._plan = plan
        self._limit = PERIOD * SPEED_SHARE * self._solver.robot.velocity
        self._last = np.array(q0)
        self._rows: list[tuple[float, ...]] = []
        self._tracking: list[str] = []
        self._worst: list[str] = []
        self._largest_jump = 0.0

    def __call__(self, t: float, _q: FloatArray, cloud: FloatArray) -> FloatArray:
        """The next targets, (19,), for the object's cloud at time t [s]."""
        if self._plan is not None:
            self.tracker.set_posture(self._plan.posture(t + PERIOD))
        step = self.tracker.step(self._goal, obstacles=cloud)
        q = step.q
        self._largest_jump = max(
            self._largest_jump, float((np.abs(q - self._last) / self._limit).max())
        )
        self._last = q
        self._rows.append(
            (
                t,
                step.time,
                step.position_error,
                step.rotation_error,
                step.balance_violation,
                step.clearance,
                step.self_distance,
            )
        )
        self._tracking.append(step.tracking)
        self._worst.append(step.worst_constraint)
        return np.asarray(q)

    def steps(self) -> Steps:
        """What it answered so far."""
        columns = np.array(self._rows).reshape(-1, 7).T
        return Steps(
            time=columns[0],
            seconds=columns[1],
            position_error=columns[2],
            rotation_error=columns[3],
            balance_violation=columns[4],
            clearance=columns[5],
            self_distance=columns[6],
            tracking=self._tracking,
            worst=self._worst,
            largest_jump=self._largest_jump,
        )
