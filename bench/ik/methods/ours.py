"""This library: the paper's method, and the default one."""

import dataclasses
from typing import Any, ClassVar

import pdoik
from bench.ik.experiment import Arm
from bench.ik.methods.problem import Answer, Problem, Terms

CONTACT_TOLERANCE = 1e-3  # c_tol, which the paper does not give [m]


def asked_for(terms: Terms) -> dict[str, Any]:
    """What all options have of the terms."""
    names = ("goal", "goal_axis", "position_tolerance", "rotation_tolerance", "max_time")
    return {name: getattr(terms, name) for name in names}


def paper_options(terms: Terms) -> pdoik.Options:
    """Algorithm IK from one start. It ends where the terms are met, or as the paper says."""
    fine = {"gradient_tolerance": 1e-12, "relative_decrease": 0.0}
    return pdoik.Options(
        **asked_for(terms),
        method="paper",
        clearance_tolerance=CONTACT_TOLERANCE,
        augmented_lagrangian=pdoik.AugmentedLagrangianOptions(
            form="printed", constraint_tolerance=CONTACT_TOLERANCE
        ),
        lbfgs=pdoik.LbfgsOptions(**fine if terms.position_tolerance < 1e-4 else {}),
    )


class PdoikDefault:
    """`method="default"` as a user gets it, but for self-collision, which no peer knows.

    Timed inside C++, taking in the cloud included.
    """

    name = "pdoik"
    language = "C++"
    changes: ClassVar[dict[str, Any]] = {}  # of the options

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._solver = pdoik.Solver(self.robot(arm), self.options(terms))

    def robot(self, arm: Arm) -> pdoik.Robot:
        return arm.robot

    def options(self, terms: Terms) -> pdoik.Options:
        usual = {"self_collision": False, "seed": terms.seed, "max_obstacles": 8192}
        return pdoik.Options(**{**asked_for(terms), **usual, **self.changes})

    def solve(self, problem: Problem) -> Answer:
        q0 = problem.q0 if problem.near_q0 else None
        return Answer.of(self._solver.solve(problem.T_base_tip, q0, problem.points))


class PdoikCapsules(PdoikDefault):
    """The default method on the shipped robot as a user gets it: capsules, kept off itself."""

    name = "pdoik, capsules"
    changes: ClassVar = {"self_collision": None}

    def robot(self, arm: Arm) -> pdoik.Robot:
        return pdoik.Robot.builtin(arm.name)


class PdoikOneStart(PdoikDefault):
    """`max_restarts=0`: the answer nearest the start, or none."""

    name = "pdoik, one start"
    changes: ClassVar = {"max_restarts": 0}


class PdoikLbfgs(PdoikDefault):
    """`inner="lbfgs"`: the paper's formulation from the default method's starts."""

    name = "pdoik, L-BFGS"
    changes: ClassVar = {"inner": "lbfgs"}


class PdoIk(PdoikDefault):
    """`method="paper"`: PDO-IK as published, its misprints corrected."""

    name = "PDO-IK"

    def options(self, terms: Terms) -> pdoik.Options:
        return paper_options(terms)


class PdoIkFromZeroSlack(PdoIk):
    """The same from omega = 0, Algorithm IK's own start, whatever start the problem names."""

    name = "PDO-IK, omega = 0"

    def solve(self, problem: Problem) -> Answer:
        return super().solve(dataclasses.replace(problem, near_q0=False))
