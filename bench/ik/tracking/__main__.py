"""Tracking at 1 kHz: a moving target, spheres that come close, every step from the last answer.

    python -m bench.ik.tracking --out build/bench/tracking

Each run is made from a motion that reaches every target clear of every sphere without a jump, so a
tracker can do as well. A step that a method does not solve leaves the arm where it was. --quick is
a two-minute version.
"""

from typing import Annotated

import pandas as pd
import typer

from bench.common import commands
from bench.common.grouped import grouped_table
from bench.common.intervals import duration
from bench.ik.experiment import ARMS, blocks, tell
from bench.ik.hard.trials import TOLERANCE
from bench.ik.methods import PEERS
from bench.ik.methods.available import available
from bench.ik.tracking.trials import DURATION, JUMP, PERIOD, SPHERES, run_method

OURS = ("pdoik, one start", "pdoik")
SLOW = ("Drake SNOPT", "mink")


def main(
    out: commands.OutFolder = commands.BUILD / "tracking",
    quick: commands.Quick = False,
    runs: Annotated[int, typer.Option(min=1, help="Per arm.")] = 10,
    slow_runs: Annotated[int, typer.Option(min=0, help="The same for Drake and mink.")] = 2,
    max_time: Annotated[float, typer.Option(help="Of one solve [s].")] = 0.1,
    seed: commands.Seed = 0,
    build: commands.BuildFolder = commands.BUILD,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
) -> None:
    """Compare at 1 kHz."""
    if quick:
        runs, slow_runs, out = 2, 0, out.with_name(out.name + "-quick")
    with commands.plain_errors():
        names, libraries = available((*OURS, *PEERS), build)
        settings = {
            "experiment": "tracking",
            "methods": names,
            "slow_runs": slow_runs,
            "libraries": libraries,
            "max_time": max_time,
            "seed": seed,
        }
        methods = [(name, slow_runs if name in SLOW else runs) for name in names]
        jobs = blocks(runs, 1, {**settings, "methods": methods}, robot=ARMS)
        trials = commands.run_campaign(out, settings, run_method, jobs, scheduler, workers)
    intro = (
        f"Runs of {round(DURATION / PERIOD)} steps, {SPHERES} spheres each, {TOLERANCE:g} m and "
        f"rad. A jump is a step of more than {JUMP:g} rad in one joint. Seed {seed}."
    )
    tell(out, f"{intro}\n\n{tracking_table(trials)}")


def tracking_table(trials: pd.DataFrame) -> str:
    """One row per arm and method, over all their runs."""
    return grouped_table(
        trials,
        {"robot": "arm", "method": "method"},
        {
            "runs": len,
            "steps solved": lambda some: f"{some.solved.sum() / some.steps.sum():.4f}",
            "runs without a lost step": lambda some: (some.solved == some.steps).sum(),
            "jumps": lambda some: some.jumps.sum(),
            "largest step [rad]": lambda some: f"{some.largest_step.max():.4f}",
            "of the known motion": lambda some: f"{some.reference_step.max():.4f}",
            "median": lambda some: duration(some["median"].median()),
            "p99.9, worst run": lambda some: duration(some.p999.max()),
            "worst": lambda some: duration(some.worst.max()),
        },
        order={"robot": ARMS},
    )


if __name__ == "__main__":
    typer.run(main)
