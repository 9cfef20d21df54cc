"""Ever more points of one table with things on it: a solve over one among 136 of them."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.large.arms import fastest, free_configurations, jobs_of
from bench.ik.lines import Line
from bench.ik.safety.world import ARMS
from bench.ik.soak.solves import Row

SIZES = (20, 100)
COUNTS = (136, 10_000, 100_000)


jobs = partial(jobs_of, COUNTS)


def table(rng: np.random.Generator, count: int) -> FloatArray:
    """Points of a table and twelve boxes on it, (count, 3) [m]."""
    half = count // 2
    flat = np.column_stack(
        [rng.uniform(0.25, 1.0, half), rng.uniform(-0.8, 0.8, half), np.zeros(half)]
    )
    n = count - half
    k, face = rng.integers(0, 12, n), rng.integers(0, 4, n)
    x, y, high = 0.35 + 0.15 * (k % 4), -0.5 + 0.5 * (k // 4), 0.05 + 0.02 * (k % 5)
    along = rng.uniform(-0.05, 0.05, n)
    side = np.where(face % 2 == 0, 0.05, -0.05)
    walls = np.column_stack(
        [
            np.where(face < 2, x + side, x + along),
            np.where(face < 2, y + along, y + side),
            rng.uniform(0, 1, n) * high,
        ]
    )
    return np.concatenate([flat, walls])


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One arm among so many, with and without an exact look."""
    robot = pdoik.Robot.builtin(job["arm"])
    rng = np.random.default_rng([job["seed"], ARMS.index(job["arm"])])
    whole = table(rng, max(COUNTS))
    all_points = pdoik.Cloud(whole)
    some = whole[rng.choice(len(whole), job["count"], replace=False)]
    cloud = pdoik.Cloud(some)
    solver = pdoik.Solver(robot)
    near = pdoik.Solver(robot, pdoik.Options(report_clearance=0.05))
    free: list[FloatArray] = []
    while len(free) < job["cases"]:
        free += [
            q
            for q in free_configurations(robot, rng, job["cases"])
            if solver.judge(robot.fk(q), q, obstacles=all_points).success
        ]
    free = free[: job["cases"]]
    rows: list[Row] = []
    for k, q in enumerate(free):
        start, T = free[k - 1], robot.fk(q)
        took, result = fastest(lambda T=T, start=start: solver.solve(T, start, cloud))
        bounded, reported = fastest(lambda T=T, start=start: near.solve(T, start, cloud))
        same = reported.clearance == min(result.clearance, 0.05) and (reported.q == result.q).all()
        rows.append(
            {
                **job,
                "took": took,
                "bounded": bounded,
                "solved": result.success,
                "wrong": not same,
            }
        )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines by number of points."""
    few = trials[trials["count"] == min(COUNTS)].took.median()
    return [
        Line(
            what=f"{count:,} points: solve; over one among 136; with report_clearance=0.05; solved",
            asked="1.5 times",
            measured=f"{duration(some.took.median())} (95 %: "
            f"{duration(some.took.quantile(0.95))}); {some.took.median() / few:.2f}; "
            f"{duration(some.bounded.median())}; {some.solved.mean():.3f}",
            cases=f"{len(some):,}",
            failures=int(some.wrong.sum()),
        )
        for count, some in trials.groupby("count")
    ]
