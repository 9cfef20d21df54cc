"""The Robotics Toolbox's compiled Levenberg-Marquardt method; answers that touch do not count."""

import importlib
from time import perf_counter
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray, z_along
from bench.ik.experiment import Arm
from bench.ik.methods.hulls import Verdict
from bench.ik.methods.problem import Answer, Problem, Terms, with_restarts

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
        began = perf_counter()
        rng = np.random.default_rng(self._terms.seed)
        succeeded = False

        def search(start: FloatArray) -> tuple[FloatArray, int, int]:
            nonlocal succeeded
            answer = self._transforms.ik_LM(
                problem.T_base_tip,
                q0=start,
                slimit=SEARCHES,
                tol=self._residual,
                joint_limits=True,
                k=DAMPING,
                method="chan",
            )
            succeeded = bool(answer.success)
            return np.asarray(answer.q), answer.iterations, max(answer.searches, 1)

        clear = self._verdict.of(problem)
        return with_restarts(
            began,
            self._terms.max_time,
            problem.q0,
            search,
            lambda q: succeeded and clear(q),
            lambda: self._arm.random_configuration(rng),
        )


def _transforms(toolbox: Any, arm: Arm) -> Any:
    """Frames whose z are the joints' axes at q = 0, each fixed to the one before."""
    robot = arm.robot
    zero = np.zeros(robot.dof)
    J, T_base_tip = robot.jacobian(zero), robot.fk(zero)
    transforms, T_base_last = toolbox.ETS(), np.eye(4)
    for linear, axis, lower, upper in zip(J[:3].T, J[3:].T, robot.lower, robot.upper, strict=True):
        T_base_joint = np.eye(4)
        T_base_joint[:3, :3] = z_along(axis)
        T_base_joint[:3, 3] = T_base_tip[:3, 3] - np.cross(linear, axis)  # where tip meets the axis
        step = toolbox.ET.SE3(np.linalg.inv(T_base_last) @ T_base_joint)
        transforms = transforms * step * toolbox.ET.Rz(qlim=[lower, upper])
        T_base_last = T_base_joint
    return transforms * toolbox.ET.SE3(np.linalg.inv(T_base_last) @ T_base_tip)
