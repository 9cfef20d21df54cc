"""dq_dT compared with central differences of solving again from the answer."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.goals.world import random_in
from bench.ik.lines import Line, jobs_of
from bench.ik.soak.solves import Row

SIZES = (1, 4)  # jobs
TARGETS = 25  # each
STEP = 2e-5  # of differences [m], [rad]
SINGULAR = 0.02  # what is nearer to a singularity is left out [m]
ASKED = 1e-6


jobs = partial(jobs_of, robot=("panda", "ur10"))


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """The largest difference over all entries, of each answer."""
    rng = np.random.default_rng([job["seed"], 6, job["index"]])
    robot = pdoik.Robot.builtin(job["robot"])
    exact = pdoik.Options(
        position_tolerance=1e-12, rotation_tolerance=1e-12, max_time=1.0, self_collision=False
    )
    solver = pdoik.Solver(robot, exact)
    rows: list[Row] = []
    while len(rows) < TARGETS:
        q = 0.9 * random_in(robot, rng) + 0.1 * robot.mid_configuration()
        T = robot.fk(q)
        known = solver.derivatives(T, q)
        if known.singular_distance < SINGULAR:
            continue
        columns = [_difference(solver, T, q, k) for k in range(6)]
        if any(column is None for column in columns):
            continue
        expected = np.column_stack(columns)
        off = np.abs(known.dq_dT - expected).max() / max(1.0, np.abs(expected).max())
        rows.append({"robot": job["robot"], "off": float(off), "wrong": bool(off > ASKED)})
    return rows


def _difference(solver: pdoik.Solver, T: FloatArray, q: FloatArray, k: int) -> FloatArray | None:
    """Richardson's central difference of fourth order along one direction; None if one fails."""

    def end(by: float) -> FloatArray | None:
        moved = T.copy()
        if k < 3:
            moved[k, 3] += by
        else:
            turn = Rotation.from_rotvec(by * np.eye(3)[k - 3]).as_matrix()
            moved[:3, :3] = turn @ T[:3, :3]
        result = solver.solve(moved, q0=q)
        return result.q if result.success and np.abs(result.q - q).max() < 0.1 else None

    ends = [end(by * STEP) for by in (-2, -1, 1, 2)]
    if any(each is None for each in ends):
        return None
    a, b, c, d = ends
    difference: FloatArray = (a - 8 * b + 8 * c - d) / (12 * STEP)
    return difference


def lines(trials: pd.DataFrame) -> list[Line]:
    """The worst."""
    return [
        Line(
            what=f"{name}: dq_dT against central differences, the worst entry of the worst answer",
            asked=f"{ASKED:g}",
            measured=f"{some.off.max():.1e}, median {some.off.median():.1e}",
            cases=f"{len(some):,} answers",
            failures=int(some.wrong.sum()),
        )
        for name, some in trials.groupby("robot")
    ]
