"""What a step costs that is held back by what it touches, compared with one that is free."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from bench.common.intervals import duration
from bench.ik.lines import Jobs, Line
from bench.ik.safety import ball
from bench.ik.safety.world import UNHURRIED, judge_of
from bench.ik.soak.solves import Row

SIZES = (1, 3)  # runs
SPEED = 0.3  # [m/s]
NEAR = 5e-4  # beyond the clearance that is asked for [m]
ASKED = (90e-6, 200e-6)  # median and p99 [s]


def jobs(size: int, seed: int) -> Jobs:
    """The same crossing, again and again."""
    return {f"{k:02d}": {"points": 116, "seed": seed} for k in range(size)}


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """A row for each step."""
    asked = (job["points"], SPEED, job["seed"])
    Q, said, absent = ball.crossing(*asked, UNHURRIED)
    clear = ball.clearances(judge_of("panda"), Q, *asked)
    return [
        {
            "touches": bool(gap < ball.CLEARANCE + NEAR),
            "time": step.time,
            "preempted": bool(waited > ball.PREEMPTED),
        }
        for gap, step, waited in zip(clear, said, absent, strict=True)
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """Median and p99 of both kinds."""
    preempted, trials = int(trials.preempted.sum()), trials[~trials.preempted]
    touching, free = trials[trials.touches].time, trials[~trials.touches].time
    median, most = touching.median(), touching.quantile(0.99)
    asked = " and ".join(map(duration, ASKED))
    return [
        Line(
            what="time of a step in contact, Panda, 116 balls: median and p99",
            asked=asked,
            measured=f"{duration(median)} and {duration(most)}; free {duration(free.median())} "
            f"and {duration(free.quantile(0.99))}, ratio {median / free.median():.1f}",
            cases=f"{len(touching):,} steps, {len(free):,} free, {preempted:,} preempted left out",
            failures=int((touching > ASKED[1]).sum()),
        )
    ]
