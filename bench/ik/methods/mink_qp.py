"""mink (MuJoCo): differential kinematics by quadratic programs, with obstacles as their limits."""

import importlib
from time import perf_counter
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.methods.hulls import Verdict, hulls_of, radius_of
from bench.ik.methods.problem import Answer, Problem, Terms, with_restarts

SOLVER = "daqp"  # what mink installs and shows
# Most were tried one at a time, on 25 to 60 problems per arm with nine spheres of 5 cm, 1 to 5 cm
# from the arm, and then taken together; differences are often within noise.
ROTATION_WEIGHT = 0.3  # metres that one radian counts as [m]
TASK_DAMPING = 0.03  # mink's lm_damping
QP_DAMPING = 1e-6
LARGEST_STEP = 1.0  # of a joint [rad]
MARGIN = 1e-4  # least distance that is asked for [m]
DETECTION = 0.02  # from where on an obstacle limits a step [m]
MAX_ITERATIONS = 50  # of one start
STALL_RATIO = 0.8  # a start ends when each of the last STALL_STEPS steps
STALL_STEPS = 2  # left more of the error than this


class MinkQp:
    """Whole steps of a frame task inside joint, step and collision limits, and random restarts.

    MuJoCo's ellipsoids are the hulls; obstacles without a radius are spheres of 1 mm. A start ends
    when its error stalls; the next one is clear of obstacles. Making the model of a scene is not
    part of any time.

    Raises:
        ImportError: mink is not installed.
        ValueError: A hull is between two links.
    """

    name = "mink"
    language = "Python"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._mujoco: Any = importlib.import_module("mujoco")
        self._mink: Any = importlib.import_module("mink")
        self._arm, self._terms = arm, terms
        self._hulls = hulls_of(arm.robot)
        self._verdict = Verdict(arm, terms)

    def solve(self, problem: Problem) -> Answer:
        """Solve it; each iteration is one evaluation."""
        configuration = self._mink.Configuration(self._model(problem.points))
        limits = self._limits(configuration.model, len(problem.points))
        rng = np.random.default_rng(self._terms.seed)
        began = perf_counter()
        tasks = self._tasks(problem.T_base_tip)

        def search(start: FloatArray) -> tuple[FloatArray, int, int]:
            configuration.update(start)
            iterations = self._descend(configuration, tasks, limits, problem, began)
            return configuration.q.copy(), iterations, 1

        solves = self._verdict.of(problem)
        draw = self._verdict.starts(problem, rng)
        return with_restarts(began, self._terms.max_time, problem.q0, search, solves, draw)

    def _descend(
        self,
        configuration: Any,
        tasks: list[Any],
        limits: list[Any],
        problem: Problem,
        began: float,
    ) -> int:
        """Steps until the goal is reached, the error stalls or time is up; how many they were."""
        last, stalled = np.inf, 0
        for iterations in range(MAX_ITERATIONS):
            verdict = self._verdict(problem, configuration.q)
            error = np.hypot(verdict.position_error, ROTATION_WEIGHT * verdict.rotation_error)
            stalled = stalled + 1 if error > STALL_RATIO * last else 0
            late = perf_counter() - began >= self._terms.max_time
            if self._reached(verdict) or stalled == STALL_STEPS or late:
                return iterations
            last = error
            try:
                velocity = self._mink.solve_ik(
                    configuration, tasks, 1.0, SOLVER, damping=QP_DAMPING, limits=limits
                )
            except self._mink.NoSolutionFound:
                return iterations
            configuration.integrate_inplace(velocity, 1.0)
        return MAX_ITERATIONS

    def _reached(self, verdict: pdoik.Result) -> bool:
        return (
            verdict.position_error <= self._terms.position_tolerance
            and verdict.rotation_error <= self._terms.rotation_tolerance
        )

    def _tasks(self, T_base_tip: FloatArray) -> list[Any]:
        mink, link = self._mink, self._arm.tip_link
        whole = self._terms.goal == "pose"
        rotation_cost = ROTATION_WEIGHT if whole else 0.0
        frame = mink.FrameTask(link, "body", 1.0, rotation_cost, lm_damping=TASK_DAMPING)
        frame.set_target(mink.SE3.from_matrix(T_base_tip))
        if whole:
            return [frame]
        axis = mink.AxisAlignTask(link, "body", cost=ROTATION_WEIGHT, lm_damping=TASK_DAMPING)
        axis.set_target(T_base_tip[:3, 2])
        return [frame, axis]

    def _limits(self, model: Any, count: int) -> list[Any]:
        mink = self._mink
        largest = dict.fromkeys(self._arm.robot.joint_names, LARGEST_STEP)
        limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, largest)]
        if count > 0:
            hulls = [f"hull{i}" for i in range(len(self._hulls))]
            limits.append(
                mink.CollisionAvoidanceLimit(
                    model,
                    [(hulls, [f"point{i}" for i in range(count)])],
                    minimum_distance_from_collisions=MARGIN,
                    collision_detection_distance=DETECTION,
                )
            )
        return limits

    def _model(self, points: FloatArray) -> Any:
        """The arm, and the obstacles as mocap bodies: mink leaves out pairs of the base's children.

        The description has no masses that MuJoCo takes; its kinematics does not care which it gets.
        """
        mujoco = self._mujoco
        spec = mujoco.MjSpec.from_file(str(self._arm.urdf))
        spec.compiler.fusestatic = False
        spec.compiler.balanceinertia = True
        spec.compiler.boundmass, spec.compiler.boundinertia = 1.0, 0.01
        for i, hull in enumerate(self._hulls):
            wxyz = np.empty(4)
            mujoco.mju_quatZ2Vec(wxyz, hull.axis)
            spec.body(hull.link).add_geom(
                name=f"hull{i}",
                type=mujoco.mjtGeom.mjGEOM_ELLIPSOID,
                size=[hull.semi_minor, hull.semi_minor, hull.semi_major],
                pos=hull.center,
                quat=wxyz,
            )
        for i, point in enumerate(points):
            body = spec.worldbody.add_body(name=f"point{i}", mocap=True, pos=point[:3])
            size = [radius_of(point), 0.0, 0.0]
            body.add_geom(name=f"point{i}", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=size)
        return spec.compile()
