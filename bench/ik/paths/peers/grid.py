"""Many solutions of every station, and the shortest way through them: a naive Descartes."""

from itertools import pairwise

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.paths.judge import MAX_STEP
from bench.ik.paths.problem import Problem

CANDIDATES, DISTINCT = 150, 0.05  # of a station, and how far apart they are [rad] or [m]
MAX_TIME = 0.03  # of a station [s]


def on_a_grid(problem: Problem, rng: np.random.Generator) -> FloatArray | None:
    """Edges are steps of no joint by more than the bound; contact between stations is not asked."""
    del rng
    solver = problem.solver(max_time=MAX_TIME)
    given, candidates = problem.world.given(), []
    for goal in problem.goals():
        all_of = solver.solve_all(
            goal, CANDIDATES, None, given, distinct=DISTINCT, T_tip_tool=problem.tool
        )
        if not len(all_of):
            return None
        candidates.append(np.asarray(all_of.q))
    cost = np.zeros(len(candidates[0]))
    back = []
    for one, other in pairwise(candidates):
        moved = np.abs(other[None] - one[:, None])
        way = cost[:, None] + np.linalg.norm(moved, axis=2)
        way[(moved > MAX_STEP).any(axis=2)] = np.inf
        back.append(way.argmin(axis=0))
        cost = way.min(axis=0)
    if not np.isfinite(cost).any():
        return None
    at = int(cost.argmin())
    Q = [candidates[-1][at]]
    for one, towards in zip(candidates[-2::-1], back[::-1], strict=True):
        at = int(towards[at])
        Q.append(one[at])
    return np.array(Q[::-1])
