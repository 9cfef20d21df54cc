"""`predict`: a posture clear of where the object will pass, and the time to take for it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

import pdoik
from pdoik.h1 import problem
from pdoik.h1.ankles import AnkleMoment
from pdoik.h1.model import Setup, World, build_world
from pdoik.h1.objects import FlyingObject
from pdoik.h1.robot import FloatArray
from pdoik.h1.standing import standing_posture
from pdoik.h1.throws import Throw

SWEPT_LEAF = 0.03  # [m]
ON_ITS_WAY = 0.5  # the sweep begins at this share of the time to the aim: before it is far off
SPREADS = (0.0, 0.1, 0.2, 0.3)  # of first guesses, in shares of the joints' ranges
BALLS = (1.0, 0.6, 0.3)  # radii of the first, coarse obstacle, in radii of the object
LEAN = (0.05, 0.3)  # how far a guess may move the torso aside [m]
SECONDS_PER_TRY = 0.05
RISE_SHARES = (1.0, 0.9, 0.8, 0.7, 0.6)  # of the time until contact that the motion takes
MOMENT_SHARE = 0.7  # of what the ankles can do, what a plan may use
MOST_POSTURES = 48  # that are looked at, about
STEP = 0.005  # of a plan's rehearsal [s]
MOMENT_STEP = 0.02  # of the momentum's differences [s]
CHECK_STEP = 0.02  # between looks at the object [s]
LAGS = (0.0, 0.06)  # how far the robot may be behind its command [s]
ENOUGH = 0.01  # clearance of the hulls along the motion, lags included [m]
RETURN_TIME = 2.0  # back to standing [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A motion to a posture, which stays clear of the object, and back."""

    q_stand: FloatArray  # (19,)
    q_dodge: FloatArray  # (19,)
    rise: float  # time to get there [s]
    back: float  # when to leave it [s]
    moments: tuple[float, float]  # the least and most it asks of both ankles together [N m]
    excess: float  # by how much these are beyond what the set-up's ankles may be asked, >= 0 [N m]
    clearance: float  # the least of the hulls to the object along it, with lags [m]
    tried: int  # first guesses
    found: int  # postures clear of the swept cloud

    def posture(self, t: float) -> FloatArray:
        """Where to be at time t [s], (19,)."""
        share = min_jerk(t / self.rise) - min_jerk((t - self.back) / RETURN_TIME)
        return np.asarray(self.q_stand + share * (self.q_dodge - self.q_stand))

    @property
    def effort(self) -> tuple[float, float]:
        """What a plan is ranked by: moment beyond the ankles', then how far the joints go."""
        distance = problem.JOINT_WEIGHTS @ (self.q_dodge - self.q_stand) ** 2
        return float(np.ceil(self.excess / 5.0)), float(distance)


def min_jerk(s: float) -> float:
    """From 0 to 1 with neither speed nor acceleration at the ends."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


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
        self._robot = problem.robot_in_world(setup)
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
        T = robot.fk(self.q_stand, problem.TORSO)
        T[:3, 3] += self._rng.uniform(*LEAN) * aside / np.linalg.norm(aside)
        T[2, 3] += 0.3  # upright where it can be
        torso = pdoik.Goal(T, type="position", weight=0.1)
        return self._guess.solve({**self._goal, problem.TORSO: torso}, q0=q).q


class Planner:
    """Takes from a search's postures the plan that the motors can follow in time."""

    def __init__(self, setup: Setup, world: World | None = None) -> None:
        self._moment = AnkleMoment(world or build_world(setup))
        self._solver = pdoik.Solver(problem.robot_in_world(setup), problem.options(setup))
        self._tracker = pdoik.Tracker(
            self._solver, STEP, speed_share=0.9, posture_weight=1e-2, smoothness=0
        )
        self._goal = problem.foot_goal(setup)
        self._setup = setup

    def plans(
        self, search: DodgeSearch, throw: Throw, thing: FlyingObject, contact_time: float
    ) -> list[Plan]:
        """All that stay clear of the object on the way, best first.

        Args:
            search: What was found.
            throw: What flies.
            thing: Its cloud.
            contact_time: When the object would touch a robot that stands still [s].
        """
        times = np.arange(ON_ITS_WAY * throw.arrival, throw.duration, CHECK_STEP)
        clouds = [throw.cloud(thing, t) for t in times]
        back = throw.arrival + 0.6 / throw.speed
        plans = []
        for q in self._worth_a_look(search):
            for share in RISE_SHARES:
                plan = self._plan(search, q, share * contact_time, back, times, clouds)
                if plan is not None:  # slower ones ask less of the ankles
                    plans.append(plan)
                    break
        return sorted(plans, key=lambda plan: plan.effort)

    def _worth_a_look(self, search: DodgeSearch) -> list[FloatArray]:
        """The postures nearest to standing, and as many from all over the rest."""
        ranked = sorted(search.postures, key=lambda q: self._distance(search, q))
        nearest, rest = ranked[: MOST_POSTURES // 2], ranked[MOST_POSTURES // 2 :]
        return nearest + rest[:: max(1, len(rest) // (MOST_POSTURES // 2))]

    @staticmethod
    def _distance(search: DodgeSearch, q: FloatArray) -> float:
        return float(problem.JOINT_WEIGHTS @ (q - search.q_stand) ** 2)

    def _plan(
        self,
        search: DodgeSearch,
        q: FloatArray,
        rise: float,
        back: float,
        times: FloatArray,
        clouds: list[FloatArray],
    ) -> Plan | None:
        """The plan if it stays clear of the clouds at `times`, which the robot may lag behind."""
        blank = Plan(
            q_stand=search.q_stand,
            q_dodge=q,
            rise=rise,
            back=back,
            moments=(0.0, 0.0),
            excess=0.0,
            clearance=0.0,
            tried=search.tried,
            found=len(search.postures),
        )
        path = self._tracked(blank, max(times[-1], back + RETURN_TIME))
        least = np.inf
        for t, cloud in zip(times, clouds, strict=True):
            for lag in LAGS:
                at = path[max(0, round((t - lag) / STEP))]
                least = min(least, self._solver.judge(self._goal, at, cloud).clearance)
            if least < ENOUGH:
                return None
        moments, force = self._moment.along(path[:: round(MOMENT_STEP / STEP)], MOMENT_STEP)
        low, high = problem.moment_limits(self._setup, force)
        beyond = np.maximum(MOMENT_SHARE * low - moments, moments - MOMENT_SHARE * high)
        return replace(
            blank,
            moments=(float(moments.min()), float(moments.max())),
            excess=max(0.0, float(beyond.max())),
            clearance=float(least),
        )

    def _tracked(self, plan: Plan, until: float) -> FloatArray:
        """What the control loop makes of a plan, feet and balance held, (K, 19), each STEP."""
        self._tracker.reset(plan.q_stand)
        path = [plan.q_stand] * 3
        for k in range(round(until / STEP)):
            self._tracker.set_posture(plan.posture((k + 1) * STEP))
            path.append(self._tracker.step(self._goal).q)
        return np.array(path[2:])
