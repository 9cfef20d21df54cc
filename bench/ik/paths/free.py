"""Poses without obstacles, where the arm keeps off itself: eight curves by four arms."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bench.ik.lines import Line
from bench.ik.paths.arms import ARMS, PLACES, by_arm
from bench.ik.paths.curves import CURVES, stations
from bench.ik.paths.placing import COUNTS, placed, somewhere, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import run_or_refer, solved, stepped, timed, worst
from bench.ik.soak.solves import Row

SIZES = (1, 12)  # of each curve and arm
jobs = by_arm
ASKED = (0.010, 0.030)  # median and 95 % [s]


def draw(arm: str, curve: str, index: int, seed: int) -> Problem:
    """One problem."""
    rng = np.random.default_rng([seed, 1, ARMS.index(arm), list(CURVES).index(curve), index])
    count = int(rng.choice(COUNTS))

    def anywhere() -> Problem:
        T = somewhere(rng, arm) @ stations(CURVES[curve](rng, PLACES[arm].size), count)
        return Problem(key=f"free:{arm}:{curve}:{index}:{seed}", arm=arm, T=T, tool=tool(rng))

    return placed(anywhere, rng)


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One of each curve."""
    problems = [draw(job["arm"], curve, job["index"], job["seed"]) for curve in CURVES]
    problems[0].ask()  # what is made once
    return [
        run_or_refer(problem, job["seed"]) | {"curve": curve}
        for curve, problem in zip(CURVES, problems, strict=True)
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of all, and of each arm."""
    found = [
        solved(trials, "poses, free"),
        timed(trials, "poses, free", ASKED),
        stepped(trials, "poses, free"),
        worst(trials, "poses, free"),
    ]
    for arm, some in trials.groupby("arm", sort=False):
        found.append(solved(some, f"... {arm}"))
        found.append(timed(some, f"... {arm}", ASKED))
    return found
