"""The motion to a posture that was found and back, which the motors can follow in time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.humanoid.dodge import problem
from bench.humanoid.dodge.ankles import AnkleMoment
from bench.humanoid.dodge.search import ON_ITS_WAY, DodgeSearch
from bench.humanoid.world.model import build_world
from bench.humanoid.world.objects import FlyingObject
from bench.humanoid.world.robot import Setup, robot_in_world
from bench.humanoid.world.throws import Throw

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
    """A quintic from 0 to 1 with neither speed nor acceleration at the ends."""
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


class Planner:
    """Takes from a search's postures the plan that the motors can follow in time."""

    def __init__(self, setup: Setup) -> None:
        self._moment = AnkleMoment(build_world(setup))
        self._solver = pdoik.Solver(robot_in_world(setup), problem.options(setup))
        self._tracker = pdoik.Tracker(
            self._solver, STEP, speed_share=0.9, posture_weight=1e-2, smoothness=0
        )
        self._goal = problem.foot_goal(setup)

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
        low, high = self._moment.limits(force)
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
