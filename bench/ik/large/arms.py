"""Where the arms may be, and how far they are from things by Pinocchio and coal."""

import time
from collections.abc import Callable, Iterable

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.lines import Jobs
from bench.ik.safety.world import ARMS, judge_of
from bench.ik.soak.hulls import capsules

REPEATS = 3  # of each solve, the fastest of which counts: other programs are running
TOUCHES = 1e-5  # what coal may find deeper before an answer is wrong [m]


def placed_capsules(
    arm: str, q: FloatArray, *, standing: bool = True
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Ends (H, 3) and radii (H,) of what the arm fills [m], perhaps without what no joint moves."""
    judge = judge_of(arm)
    a, b = judge.hulls(judge.kinematics.place(q[None]))
    ends, others, radii = capsules(a, b, judge.A, judge.swept)
    kept = np.ones(len(judge.A), dtype=bool) if standing else ~judge.fixed
    return ends[0, kept], others[0, kept], np.broadcast_to(radii, ends.shape[:2])[0, kept]


def free_configurations(
    robot: pdoik.Robot, rng: np.random.Generator, count: int
) -> list[FloatArray]:
    """Off itself."""
    solver, free = pdoik.Solver(robot), []
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    while len(free) < count:
        q = rng.uniform(low, high)
        if solver.judge(robot.fk(q), q).success:
            free.append(q)
    return free


def fastest(ask: Callable[[], pdoik.Result]) -> tuple[float, pdoik.Result]:
    """Least time of a few calls [s], and the last result."""
    ask()
    least = np.inf
    for _ in range(REPEATS):
        began = time.perf_counter()
        result = ask()
        least = min(least, time.perf_counter() - began)
    return least, result


def jobs_of(sizes: Iterable[int], size: int, seed: int) -> Jobs:
    """One of each arm and number of things."""
    return {
        f"{count:07d}-{arm}": {"arm": arm, "count": count, "cases": size, "seed": seed}
        for count in sizes
        for arm in ARMS
    }
