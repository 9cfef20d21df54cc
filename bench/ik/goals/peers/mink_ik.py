"""mink: steps of quadratic programs, regions as tasks, contacts as limits of a step."""

import importlib
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.goals.peers.body import Body
from bench.ik.goals.peers.mink_aims import TASK_DAMPING, Aim, aim_of
from bench.ik.goals.peers.mink_model import contact_limit, model_of
from bench.ik.goals.peers.problems import (
    Answer,
    Region,
    Search,
    among,
    by_distance,
    from_starts,
    least_of,
)

# As bench/ik/methods/mink_qp.py has them, which says how they were found.
SOLVER, QP_DAMPING = "daqp", 1e-6
LARGEST_STEP = 1.0  # of a joint [rad]
STALL_RATIO, STALL_STEPS = 0.8, 2  # a start ends when so many steps in a row leave more than this
ITERATIONS = 100  # of a start
SHARE = 0.5  # of a tolerance, at which a search ends
# Of an orientation behind a position, one after the other.
WEIGHTS = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003, 0.0001)


class MinkIk:
    """Whole steps inside joint, step and collision limits.

    Raises:
        ImportError: mink is not installed.
    """

    def __init__(self, body: Body) -> None:
        self._mujoco: Any = importlib.import_module("mujoco")
        self._mink: Any = importlib.import_module("mink")
        self.name = f"mink {version('mink')}"
        self._body = body
        model = model_of(self._mujoco, body)
        self._configuration = self._mink.Configuration(model)
        self._at = [int(model.joint(name).qposadr[0]) for name in body.moving]
        robot = body.robot
        self._ends = robot.lower[body.places], robot.upper[body.places]
        largest = dict.fromkeys(body.moving, LARGEST_STEP)
        self._limits = [
            self._mink.ConfigurationLimit(model),
            self._mink.VelocityLimit(model, largest),
        ]
        self._contacts = contact_limit(self._mink, model, body) if body.has_contacts else None

    def solve(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """Until one is in all regions and touches nothing."""
        aims = [aim_of(self._mink, region) for region in regions]
        return from_starts(lambda start: self._search(aims, start), starts)

    def any_of(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """Each with tasks of its own, nearest first."""
        order = by_distance(regions, self._pose(regions[0].tip, starts[0]))

        def search_of(region: Region) -> Search:
            aims = [aim_of(self._mink, region)]
            return lambda start: self._search(aims, start)

        answer = among([search_of(regions[k]) for k in order], starts)
        return replace(answer, index=order[answer.index])

    def nearest(self, T: FloatArray, tip: str, starts: FloatArray) -> Answer:
        """The best of several weights of the orientation, each from the end of the one before."""
        tolerance = Region(tip=tip, T=T).tolerance
        target = self._mink.SE3.from_matrix(T)

        def search(start: FloatArray) -> tuple[FloatArray, float]:
            self._place(start)
            least, best = np.inf, start
            for weight in WEIGHTS:
                task = self._mink.FrameTask(tip, "body", 1.0, weight, lm_damping=TASK_DAMPING)
                task.set_target(target)
                last = np.inf
                for _ in range(ITERATIONS):
                    error = task.compute_error(self._configuration) * task.cost
                    cost = float(error @ error)
                    if cost > last * (1 - 1e-9):
                        break
                    last = cost
                    if not self._step([task], self._limits):
                        break
                off = task.compute_error(self._configuration)
                turned = float(np.linalg.norm(off[3:]))
                if np.linalg.norm(off[:3]) <= SHARE * tolerance and turned < least:
                    least, best = turned, self._outer(start)
            return best, least

        return least_of(search, starts)

    def _search(self, aims: Sequence[Aim], start: FloatArray) -> tuple[FloatArray, bool]:
        """First without contacts, which are checked at the end; with them if need be."""
        if not self._descend(aims, start, self._limits):
            return self._outer(start), False
        if self._is_clear():
            return self._outer(start), True
        held = self._descend(aims, start, [*self._limits, self._contacts])
        return self._outer(start), held and self._is_clear()

    def _descend(self, aims: Sequence[Aim], start: FloatArray, limits: Sequence[Any]) -> bool:
        """Whether it got into all."""
        self._place(start)
        tasks = [task for aim in aims for task in aim.tasks]
        last, stalled = np.inf, 0
        for _ in range(ITERATIONS):
            missing = max(aim.update(self._configuration) for aim in aims)
            if missing <= SHARE:
                return True
            stalled = stalled + 1 if missing > STALL_RATIO * last else 0
            if stalled == STALL_STEPS or not self._step(tasks, limits):
                return False
            last = missing
        return False

    def _step(self, tasks: Sequence[Any], limits: Sequence[Any]) -> bool:
        """Whether there was one."""
        try:
            velocity = self._mink.solve_ik(
                self._configuration, tasks, 1.0, SOLVER, damping=QP_DAMPING, limits=limits
            )
        except self._mink.NoSolutionFound:
            return False
        own = self._configuration.integrate(velocity, 1.0)
        own[self._at] = np.clip(own[self._at], *self._ends)  # limits hold to the solver's tolerance
        self._configuration.update(own)
        return True

    def _place(self, q: FloatArray) -> None:
        own = self._configuration.q
        own[self._at] = q[self._body.places]
        self._configuration.update(own)

    def _outer(self, start: FloatArray) -> FloatArray:
        q = start.copy()
        q[self._body.places] = self._configuration.q[self._at]
        return q

    def _pose(self, link: str, q: FloatArray) -> FloatArray:
        self._place(q)
        at = self._configuration.get_transform_frame_to_world(link, "body")
        pose: FloatArray = at.as_matrix()
        return pose

    def _is_clear(self) -> bool:
        """Whether MuJoCo finds no contacts."""
        if self._contacts is None:
            return True
        data = self._configuration.data
        self._mujoco.mj_collision(self._configuration.model, data)
        return bool(data.ncon == 0)
