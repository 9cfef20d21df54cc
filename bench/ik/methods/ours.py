"""This library: the paper's method, and the default one."""

from __future__ import annotations

import dataclasses

import pdoik
from bench.ik.experiment import Arm
from bench.ik.methods.problem import Answer, FloatArray, Problem, Terms

CONTACT_TOLERANCE = 1e-3  # c_tol, which the paper does not give [m]


def paper_options(terms: Terms) -> pdoik.Options:
    """Algorithm IK from one start. It ends where the terms are met, or as the paper says."""
    return pdoik.Options(
        goal=terms.goal,
        goal_axis=terms.goal_axis,
        method="paper",
        position_tolerance=terms.position_tolerance,
        rotation_tolerance=terms.rotation_tolerance,
        clearance_tolerance=CONTACT_TOLERANCE,
        augmented_lagrangian=pdoik.AugmentedLagrangianOptions(
            form="printed", constraint_tolerance=CONTACT_TOLERANCE
        ),
        lbfgs=pdoik.LbfgsOptions(gradient_tolerance=1e-12, relative_decrease=0.0)
        if terms.position_tolerance < 1e-4
        else pdoik.LbfgsOptions(),
        max_time=terms.max_time,
    )


def default_options(terms: Terms) -> pdoik.Options:
    """As a user gets it, but for goal, tolerances and self-collision, which no peer knows."""
    return pdoik.Options(
        self_collision=False,
        goal=terms.goal,
        goal_axis=terms.goal_axis,
        position_tolerance=terms.position_tolerance,
        rotation_tolerance=terms.rotation_tolerance,
        max_time=terms.max_time,
        seed=terms.seed,
        max_obstacles=8192,
    )


class _Pdoik:
    """Timed inside C++, taking in the cloud included."""

    name: str
    language = "C++"

    def __init__(self, arm: Arm, options: pdoik.Options) -> None:
        self._solver = pdoik.Solver(arm.robot, options)

    def solve(self, problem: Problem) -> Answer:
        return self._timed(problem, problem.q0 if problem.near_q0 else None)

    def _timed(self, problem: Problem, q0: FloatArray | None) -> Answer:
        result = self._solver.solve(problem.T_base_tip, q0, problem.points)
        return Answer(
            q=result.q,
            claimed=result.success,
            time=result.time,
            iterations=result.iterations,
            evaluations=result.evaluations,
            restarts=result.restarts,
        )


class PdoIk(_Pdoik):
    """`method="paper"`: PDO-IK as published, its misprints corrected."""

    name = "PDO-IK"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        super().__init__(arm, paper_options(terms))


class PdoikDefault(_Pdoik):
    """`method="default"`."""

    name = "pdoik"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        super().__init__(arm, default_options(terms))


class PdoikCapsules(_Pdoik):
    """The default method on the shipped robot as a user gets it: capsules, kept off itself."""

    name = "pdoik, capsules"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        options = dataclasses.replace(default_options(terms), self_collision=None)
        super().__init__(dataclasses.replace(arm, robot=pdoik.Robot.builtin(arm.name)), options)


class PdoikOneStart(_Pdoik):
    """`max_restarts=0`: the answer nearest the start, or none."""

    name = "pdoik, one start"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        super().__init__(arm, dataclasses.replace(default_options(terms), max_restarts=0))


class PdoikLbfgs(_Pdoik):
    """`inner="lbfgs"`: the paper's formulation from the default method's starts."""

    name = "pdoik, L-BFGS"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        super().__init__(arm, dataclasses.replace(default_options(terms), inner="lbfgs"))


class PdoIkFromZeroSlack(PdoIk):
    """The same from omega = 0, Algorithm IK's own start, whatever start the problem names."""

    name = "PDO-IK, omega = 0"

    def solve(self, problem: Problem) -> Answer:
        return self._timed(problem, None)
