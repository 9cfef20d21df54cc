"""The Robotics Toolbox's compiled Levenberg-Marquardt method; answers that touch do not count."""

from __future__ import annotations

import importlib
from time import perf_counter
from typing import Any

import numpy as np

from bench.ik.experiment import Arm, FloatArray
from bench.ik.methods.hulls import Verdict
from bench.ik.methods.problem import Answer, Problem, Terms

# Chan's damping is its default. Of k = 1, 0.1 and 0.01, in the range its documentation advises, 0.1
# has the best medians of 100 poses per arm without obstacles; among nine spheres also on UR10 and
# iiwa14, but not on Panda (0.32 ms, 0.27 for 1). The other two methods were tried with two k each.
DAMPING = 0.1
SEARCHES = 10  # of its own, from one start; its default, 100, may overrun a short time


class ToolboxLm:
    """`ETS.ik_LM` with its own restarts, then again from random starts while time allows.

    Its sequence of elementary transforms is made from the arm's kinematics, so that frames and
    limits are the same. Its error is in the base frame: it knows whole poses only.

    Raises:
        ImportError: roboticstoolbox-python is not installed.
        ValueError: The terms are for axis goals.
    """

    name = "Robotics Toolbox LM"
    language = "C++"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        if terms.goal != "pose":
            raise ValueError("the Robotics Toolbox's ik_LM knows whole poses only")
        self._arm, self._terms = arm, terms
        self._transforms = _transforms(importlib.import_module("roboticstoolbox"), arm)
        self._verdict = Verdict(arm, terms)
        tightest = min(terms.position_tolerance, terms.rotation_tolerance)
        self._residual = 0.5 * tightest**2  # half the squared error: both tolerances hold

    def solve(self, problem: Problem) -> Answer:
        """Solve it; each iteration is one evaluation."""
        begin = perf_counter()
        rng = np.random.default_rng(self._terms.seed)
        start, iterations, searches = problem.q0, 0, 0
        while True:
            answer = self._transforms.ik_LM(
                problem.T_base_tip,
                q0=start,
                slimit=SEARCHES,
                tol=self._residual,
                joint_limits=True,
                k=DAMPING,
                method="chan",
            )
            iterations += answer.iterations
            searches += max(answer.searches, 1)
            found = answer.success and self._verdict(problem, answer.q).success
            time = perf_counter() - begin
            if found or time >= self._terms.max_time:
                break
            start = self._arm.random_configuration(rng)
        return Answer(
            q=np.asarray(answer.q),
            claimed=bool(found and time < self._terms.max_time),
            time=time,
            iterations=iterations,
            evaluations=iterations,
            restarts=searches - 1,
        )


def _transforms(toolbox: Any, arm: Arm) -> Any:
    """Frames whose z are the joints' axes at q = 0, each fixed to the one before."""
    robot = arm.robot
    zero = np.zeros(robot.dof)
    J, T_base_tip = robot.jacobian(zero), robot.fk(zero)
    transforms, T_base_last = toolbox.ETS(), np.eye(4)
    for linear, axis, lower, upper in zip(J[:3].T, J[3:].T, robot.lower, robot.upper, strict=True):
        T_base_joint = np.eye(4)
        T_base_joint[:3, :3] = _frame_of(axis)
        T_base_joint[:3, 3] = T_base_tip[:3, 3] - np.cross(linear, axis)  # where tip meets the axis
        step = toolbox.ET.SE3(np.linalg.inv(T_base_last) @ T_base_joint)
        transforms = transforms * step * toolbox.ET.Rz(qlim=[lower, upper])
        T_base_last = T_base_joint
    return transforms * toolbox.ET.SE3(np.linalg.inv(T_base_last) @ T_base_tip)


def _frame_of(z: FloatArray) -> FloatArray:
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
