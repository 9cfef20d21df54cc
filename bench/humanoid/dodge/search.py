"""Postures clear of where a thrown object will pass."""

from __future__ import annotations

import time

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.humanoid.dodge import problem
from bench.humanoid.world.objects import FlyingObject
from bench.humanoid.world.robot import TORSO, Setup, robot_in_world
from bench.humanoid.world.standing import standing_posture
from bench.humanoid.world.throws import Throw

SWEPT_LEAF = 0.03  # [m]
ON_ITS_WAY = 0.5  # the sweep begins at this share of the time to the aim: before it is far off
SPREADS = (0.0, 0.1, 0.2, 0.3)  # of first guesses, in shares of the joints' ranges
BALLS = (1.0, 0.6, 0.3)  # radii of the first, coarse obstacle, in radii of the object
LEAN = (0.05, 0.3)  # how far a guess may move the torso aside [m]
SECONDS_PER_TRY = 0.05


class DodgeSearch:
    """Postures clear of a throw's swept cloud, found from many first guesses.

    Each guess is solved twice. First against a few balls along the object's path: unlike the
    surface of what it sweeps, which may lie around a limb and push it from all sides, their centres
    push it off the path. Then from there against the swept cloud. Guesses alternate between joint
    space around standing and a torso that leans aside.
    """

    def __init__(self, setup: Setup, thing: FlyingObject, throw: Throw, seed: int = 0) -> None:
        self.setup = setup
        self.q_stand = standing_posture(setup)
        self._robot = robot_in_world(setup)
        self._goal = problem.foot_goal(setup)
        self._rng = np.random.default_rng(seed)
        begin = ON_ITS_WAY * throw.arrival
        self._cloud = throw.swept_cloud(thing, begin, throw.duration, leaf=SWEPT_LEAF)
        self._middles = np.array(
            [throw.pose(t)[:3, 3] for t in np.linspace(begin, throw.duration, 120)]
        )
        self._radius = thing.radius
        way = np.array(throw.aim) - np.array(throw.start)
        self._way = way / np.linalg.norm(way)
        self._guess = pdoik.Solver(
            self._robot, pdoik.Options(balance=problem.balance(setup), max_restarts=0)
        )
        self._solver = pdoik.Solver(
            self._robot, problem.options(setup, max_restarts=0, max_time=SECONDS_PER_TRY)
        )
        self.tried = 0
        self.postures: list[FloatArray] = []

    def search(self, seconds: float) -> None:
        """Go on looking for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.attempt()

    def attempt(self) -> pdoik.Result:
        """One guess; what it came to."""
        q = self._first_guess()
        radius = self._radius * BALLS[self.tried // len(SPREADS) % len(BALLS)]
        balls = np.column_stack([self._middles, np.full(len(self._middles), radius)])
        self.tried += 1
        q = self._solver.solve(self._goal, q0=q, obstacles=balls, posture=self.q_stand).q
        found = self._solver.solve(self._goal, q0=q, obstacles=self._cloud, posture=self.q_stand)
        if found.success and not any(self._same(found.q, known) for known in self.postures):
            self.postures.append(found.q)
        return found

    @staticmethod
    def _same(a: FloatArray, b: FloatArray) -> bool:
        return bool(np.abs(a - b).max() < 1e-2)

    def _first_guess(self) -> FloatArray:
        robot = self._robot
        spread = SPREADS[self.tried % len(SPREADS)] * (robot.upper - robot.lower)
        q = np.clip(
            self.q_stand + spread * self._rng.uniform(-0.5, 0.5, robot.dof),
            robot.lower,
            robot.upper,
        )
        if self.tried % 2 == 0:
            return np.asarray(q)
        aside = self._rng.normal(size=3)
        aside -= aside @ self._way * self._way
        T = robot.fk(self.q_stand, TORSO)
        T[:3, 3] += self._rng.uniform(*LEAN) * aside / np.linalg.norm(aside)
        T[2, 3] += 0.3  # upright where it can be
        torso = pdoik.Goal(T, type="position", weight=0.1)
        return self._guess.solve({**self._goal, TORSO: torso}, q0=q).q
