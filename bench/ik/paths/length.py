"""How long motions are compared with the shortest that a sampling search finds."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bench.ik.lines import Jobs, Line, jobs_of, share
from bench.ik.paths import axis, free
from bench.ik.paths.arms import ARMS
from bench.ik.paths.curves import CURVES
from bench.ik.paths.runs import row_of
from bench.ik.paths.sampling import search
from bench.ik.soak.solves import Row

SIZES = (1, 8)  # curves of each arm and row
DRAW = {"free": free.draw, "axis": axis.draw}
TIMES = (3.0, 30.0)  # of a search in a short version and else [s]
ASKED = 1.05
FIRST = 100  # no problem is another row's


def jobs(size: int, seed: int) -> Jobs:
    """A search each."""
    search = TIMES[size > SIZES[0]]
    every = jobs_of(size, seed, row=DRAW, arm=ARMS)
    return {name: {**job, "search": search} for name, job in every.items()}


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One path by the library and by the search."""
    curve = list(CURVES)[job["index"] % len(CURVES)]
    index = FIRST + job["index"] // len(CURVES)
    problem = DRAW[job["row"]](job["arm"], curve, index, job["seed"])
    row = row_of(problem, problem.ask())
    rng = np.random.default_rng([job["seed"], 97, job["index"]])
    found = search(problem, job["search"], rng)
    ours = row["length"] if row["whole"] and not row["wrong"] else np.inf
    return [
        row
        | {
            "row": job["row"],
            "search": job["search"],
            "tries": found.tries,
            "best": found.length,
            "ratio": ours / found.length if found.length < np.inf else np.nan,
        }
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """The ratios."""
    found = []
    for row, every in trials.groupby("row", sort=False):
        some = every[np.isfinite(every.ratio)]
        ours_only = int((every.whole & ~np.isfinite(every.best)).sum())
        not_ours = int((np.isinf(every.ratio)).sum())
        found.append(
            Line(
                what=f"row {row}: length over the best of a search of {every.search.iloc[0]:g} s, "
                f"{every.tries.median():.0f} starts",
                asked=f"at most {ASKED}",
                measured=f"at most {ASKED}: {share(some.ratio <= ASKED, len(some))}; median "
                f"{some.ratio.median():.3f}, 95 % {some.ratio.quantile(0.95):.3f}, most "
                f"{some.ratio.max():.3f}; found by one only: {ours_only} and {not_ours}",
                cases=f"{len(some)} that both found",
                failures=int((some.ratio > ASKED).sum()) + not_ours,
            )
        )
    return found
