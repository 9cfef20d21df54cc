"""Closed paths: one round ends where it began, so that any number of rounds is the same motion."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bench.ik.lines import Line
from bench.ik.paths.arms import ARMS, PLACES, by_arm
from bench.ik.paths.curves import CURVES, stations
from bench.ik.paths.placing import COUNTS, placed, somewhere, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import asked, refer, row_of, solved, stepped, timed, worst
from bench.ik.soak.solves import Row

SIZES = (1, 12)  # of each curve and arm
jobs = by_arm
ROUND = ("circle", "rounded", "square", "turns")
ASKED = (0.010, 0.030)  # as of other free paths [s]


def draw(arm: str, curve: str, index: int, seed: int) -> Problem:
    """One problem."""
    rng = np.random.default_rng([seed, 5, ARMS.index(arm), ROUND.index(curve), index])
    count = int(rng.choice(COUNTS))

    def anywhere() -> Problem:
        T = stations(CURVES[curve](rng, PLACES[arm].size), count, closed=True)
        return Problem(
            key=f"closed:{arm}:{curve}:{index}:{seed}",
            arm=arm,
            T=somewhere(rng, arm) @ T,
            tool=tool(rng),
            closed=True,
        )

    return placed(anywhere, rng)


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One of each curve."""
    rows: list[Row] = []
    for curve in ROUND:
        problem = draw(job["arm"], curve, job["index"], job["seed"])
        if not rows:
            problem.ask()  # what is made once
        path, took = asked(problem)
        row = row_of(problem, path) | {"curve": curve, "processor": took, "open": np.nan}
        if path.success:
            row["open"] = float(np.abs(path.q[-1] - path.q[0]).max())
            row["wrong"] |= row["open"] != 0.0
        rows.append(row | refer(problem, row, job["seed"]))
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Whether they end where they began."""
    some = trials[trials.whole]
    return [
        solved(trials, "closed"),
        timed(trials, "closed", ASKED),
        Line(
            what="closed: a joint's difference between the end of a round and its start",
            asked="0",
            measured=f"at most {some.open.max():g} rad" if len(some) else "none",
            cases=f"{len(some):,}",
            failures=int((some.open != 0.0).sum()),
        ),
        stepped(trials, "closed"),
        worst(trials, "closed"),
    ]
