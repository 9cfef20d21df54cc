"""The same paths by what a user would try instead, judged alike.

A peer gives a configuration for each station, joined by straight lines. What it says of them is not
asked: a path is whole if the judge finds nothing wrong with it; and besides that, if nothing is
wrong but the way between stations, of which peers know nothing.
"""

from collections.abc import Mapping
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd

from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.lines import Line, jobs_of, share
from bench.ik.paths import axis, free
from bench.ik.paths.arms import ARMS
from bench.ik.paths.curves import CURVES
from bench.ik.paths.judge import judged
from bench.ik.paths.peers.chains import chained, in_moveits_way
from bench.ik.paths.peers.grid import on_a_grid
from bench.ik.paths.problem import Problem
from bench.ik.soak.solves import Row

__all__ = ["SIZES", "jobs", "lines", "run_job"]

SIZES = (1, 8)  # curves of each arm and row
DRAW = {"free": free.draw, "axis": axis.draw}
BETWEEN = {"way_position", "way_rotation"}


jobs = partial(jobs_of, row=DRAW, arm=ARMS)


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One path by each."""
    curve = list(CURVES)[job["index"] % len(CURVES)]
    problem = DRAW[job["row"]](job["arm"], curve, job["index"] // len(CURVES), job["seed"])
    path = problem.ask()
    rows = [_row(problem, "pdoik", path.q if path.success else None, path.at, path.time)]
    at = np.arange(problem.last + 1.0)
    for name, method in _methods().items():
        rng = np.random.default_rng([job["seed"], 96, job["index"]])
        began = perf_counter()
        Q = method(problem, rng)
        rows.append(_row(problem, name, Q, at, perf_counter() - began))
    return [row | {"row": job["row"], "curve": curve} for row in rows]


def _methods() -> dict[str, Any]:
    methods = {
        "chained solves": chained,
        "chained, stopped at jumps, 20 starts (MoveIt's way)": in_moveits_way,
        "all solutions on a grid of stations (Descartes' way)": on_a_grid,
    }
    try:
        from bench.ik.paths.peers.mink_following import follows
    except ImportError:
        return methods
    return {**methods, "mink, following": follows}


def _row(problem: Problem, method: str, Q: FloatArray | None, at: FloatArray, time: float) -> Row:
    row: Row = {"key": problem.key, "method": method, "time": time, "claimed": Q is not None}
    if Q is None:
        return row | {"whole": False, "at_stations": False, "faults": ""}
    verdict = judged(problem, np.asarray(Q), np.asarray(at))
    return row | {
        **verdict.row(),
        "whole": not verdict.faults,
        "at_stations": not set(verdict.faults) - BETWEEN,
    }


def lines(trials: pd.DataFrame) -> list[Line]:
    """Each method, of what any of them can."""
    found = []
    for row, every in trials.groupby("row", sort=False):
        feasible = set(every[every.whole].key)
        for method, some in every[every.key.isin(feasible)].groupby("method", sort=False):
            claimed = some[some.claimed]
            faults = " ".join(claimed.faults).split()
            counts = ", ".join(f"{faults.count(f)} {f}" for f in dict.fromkeys(faults))
            found.append(
                Line(
                    what=f"row {row}: {method}: whole of feasible; whole at stations",
                    asked="",
                    measured=f"{share(some.whole, len(some))}; "
                    f"{share(some.at_stations, len(some))}; answers {len(claimed)}"
                    + (f" ({counts})" if counts else "")
                    + f"; median {duration(some.time.median())} "
                    f"(95 %: {duration(some.time.quantile(0.95))})",
                    cases=f"{len(some)}",
                    failures=int((claimed.whole == 0).sum()),
                )
            )
    return found
