"""PDO-IK's objective, obstacles, outer loop and stopping rule under SciPy's L-BFGS-B.

The paper's third baseline, Angle-LBFGS-B, has the joint angles as variables and their limits as
bounds. The same minimiser over PDO-IK's own variables tells how much of a difference is the
variables', and how much the language's and the minimiser's: both call the C++ rollout through
pdoik.Lagrangian for every value and gradient.
"""

import time
from typing import Any, Literal

import numpy as np
from scipy.optimize import minimize

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.methods.ours import paper_options
from bench.ik.methods.problem import Answer, Problem, Terms

_STOPPED = 99  # SciPy's status of a minimisation that its callback ended


class AngleLbfgsB:
    """The paper's third baseline."""

    name = "Angle-LBFGS-B"
    language = "Python (SciPy) on the C++ rollout"
    variables: Literal["slack", "positions"] = "positions"
    bounded = True

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._options = paper_options(terms)
        self._objective = pdoik.Lagrangian(arm.robot, self._options, self.variables)
        self._range = np.column_stack([arm.robot.lower, arm.robot.upper])

    def solve(self, problem: Problem) -> Answer:
        """Algorithm IK, its line numbers at the right."""
        started = time.perf_counter()
        deadline = started + self._options.max_time
        options, objective = self._options.augmented_lagrangian, self._objective
        objective.set_target(problem.T_base_tip)
        objective.set_obstacles(problem.points)
        lower, upper = self._range.T
        inset = self._options.start_inset * (upper - lower)
        x = objective.variables(np.clip(problem.q0, lower + inset, upper - inset))  # 1
        rho, last = options.rho, np.inf
        iterations = evaluations = 0
        for _ in range(options.max_outer_iterations):
            found = self._minimise(x, rho, deadline)  # 3
            x = found.x
            iterations += found.nit
            evaluations += found.nfev
            largest = objective.max_constraint(x)
            if found.status == _STOPPED or largest < options.constraint_tolerance:  # 4
                break
            if largest >= options.beta * last:  # 4
                break
            last = largest  # 8
            objective.update_multipliers(x, rho)  # 9
            rho = min(options.rho_growth * rho, options.rho_max)  # 10
        objective(x, rho)
        return Answer(
            q=objective.positions(x),
            claimed=self._solved(),
            time=time.perf_counter() - started,
            iterations=iterations,
            evaluations=evaluations,
        )

    def _solved(self) -> bool:
        """Whether the last point that was evaluated passes the test that ends method "paper"."""
        return bool(
            self._objective.last_position_error < self._options.position_tolerance
            and self._objective.last_rotation_error < self._options.rotation_tolerance
            and self._objective.last_max_constraint <= 0.5 * self._options.clearance_tolerance
        )

    def _minimise(self, x: FloatArray, rho: float, deadline: float) -> Any:
        lbfgs = self._options.lbfgs

        def stop_where_solved(intermediate_result: Any) -> None:
            self._objective(intermediate_result.x, rho)  # a line search may have ended elsewhere
            if self._solved() or time.perf_counter() > deadline:
                raise StopIteration

        return minimize(
            self._objective,
            x,
            args=(rho,),
            jac=True,
            method="L-BFGS-B",
            bounds=self._range if self.bounded else None,
            callback=stop_where_solved,
            options={
                "maxcor": lbfgs.memory,
                "maxiter": lbfgs.max_iterations,
                "maxls": lbfgs.max_line_search,
                "maxfun": lbfgs.max_iterations * lbfgs.max_line_search,
                "gtol": lbfgs.gradient_tolerance,
                "ftol": lbfgs.relative_decrease,
            },
        )


class SlackLbfgs(AngleLbfgsB):
    """PDO-IK's variables under the same minimiser, without bounds."""

    name = "Slack-LBFGS"
    variables = "slack"
    bounded = False
