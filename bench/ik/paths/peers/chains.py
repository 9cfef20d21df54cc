"""A solve for each station, from the one before."""

from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.paths.judge import MAX_STEP
from bench.ik.paths.problem import Problem

STARTS = 20
MAX_TIME = 0.05  # of a solve [s]


def chained(problem: Problem, rng: np.random.Generator) -> FloatArray | None:
    """Chain from any first solution, wherever it leads: "200 of 200 solved"."""
    del rng
    return _chain(problem, problem.solver(max_time=MAX_TIME), None, np.inf)


def in_moveits_way(problem: Problem, rng: np.random.Generator) -> FloatArray | None:
    """It ends where a joint jumps, and is tried again from another start."""
    solver = problem.solver(max_time=MAX_TIME)
    robot = problem.robot
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    for k in range(STARTS):
        Q = _chain(problem, solver, rng.uniform(low, high) if k else None, MAX_STEP)
        if Q is not None:
            return Q
    return None


def _chain(
    problem: Problem, solver: pdoik.Solver, q: FloatArray | None, largest: float
) -> FloatArray | None:
    given: Any = problem.world.given()
    if isinstance(given, np.ndarray):
        given = pdoik.Cloud(given)  # taken in once
    Q: list[Any] = []
    for goal in problem.goals():
        result = solver.solve(goal, q, given, T_tip_tool=problem.tool)
        if not result.success:
            return None
        if Q and np.abs(result.q - Q[-1]).max() > largest:
            return None
        q = np.asarray(result.q)
        Q.append(q)
    if problem.closed:
        Q.append(Q[0])
    return np.array(Q)
