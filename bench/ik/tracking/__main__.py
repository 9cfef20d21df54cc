"""Tracking at 1 kHz: a moving target, spheres that come close, every step from the last answer.

    python -m bench.ik.tracking --out build/bench/tracking

Each run is made from a motion that reaches every target clear of every sphere without a jump, so a
tracker can do as well. A step that a method does not solve leaves the arm where it was. --quick is
a two-minute version.
"""

from __future__ import annotations

from typing import Annotated

import pandas as pd
import typer

from bench.common.commands import (
    BUILD,
    BuildFolder,
    OutFolder,
    Quick,
    Scheduler,
    Seed,
    Workers,
    console,
    plain_errors,
    run_campaign,
    show,
    write_report,
)
from bench.common.intervals import duration
from bench.common.markdown import markdown_table
from bench.common.peer_library import build_peers
from bench.ik.experiment import ARMS
from bench.ik.methods import PEERS
from bench.ik.methods.available import available
from bench.ik.tracking.trials import DURATION, JUMP, PERIOD, SPHERES, TOLERANCE, run_method

OURS = ("pdoik, one start", "pdoik")


def main(
    out: OutFolder = BUILD / "tracking",
    quick: Quick = False,
    runs: Annotated[int, typer.Option(min=1, help="Per arm.")] = 10,
    slow_runs: Annotated[int, typer.Option(min=0, help="The same for Drake and mink.")] = 2,
    max_time: Annotated[float, typer.Option(help="Of one solve [s].")] = 0.1,
    seed: Seed = 0,
    build: BuildFolder = BUILD,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Compare at 1 kHz."""
    if quick:
        runs, slow_runs, out = 2, 0, out.with_name(out.name + "-quick")
    with plain_errors():
        with console.status("building the peers"):
            libraries = build_peers(build)
        names = available((*OURS, *PEERS), libraries)
        slow = {"Drake SNOPT", "mink"}
        settings = {
            "experiment": "tracking",
            "methods": names,
            "slow_runs": slow_runs,
            "libraries": str(libraries),
            "max_time": max_time,
            "seed": seed,
        }
        jobs = {
            f"{robot}-{index:03d}": {
                **settings,
                "robot": robot,
                "index": index,
                "methods": [name for name in names if name not in slow or index < slow_runs],
            }
            for index in range(runs)
            for robot in ARMS
        }
        trials = run_campaign(out, settings, run_method, jobs, scheduler, workers)
    steps = round(DURATION / PERIOD)
    intro = (
        f"Runs of {steps} steps, {SPHERES} spheres each, {TOLERANCE:g} m and rad. A jump is a step "
        f"of more than {JUMP:g} rad in one joint. Seed {seed}."
    )
    table = tracking_table(trials)
    write_report(out / "tables.md", f"{intro}\n\n{table}")
    show(f"{intro}\n\n{table}")
    console.print(f"tables: {out}/tables.md; trials: trials.parquet")


def tracking_table(trials: pd.DataFrame) -> str:
    """One row per arm and method, over all their runs."""
    header = ["arm", "method", "runs", "steps solved", "runs without a lost step", "jumps"]
    header += ["largest step [rad]", "of the known motion", "median", "p99.9, worst run", "worst"]
    rows = []
    for (robot, method), some in trials.groupby(["robot", "method"], sort=False):
        rows.append(
            [
                robot,
                method,
                len(some),
                f"{some.solved.sum() / some.steps.sum():.4f}",
                int((some.solved == some.steps).sum()),
                int(some.jumps.sum()),
                f"{some.largest_step.max():.4f}",
                f"{some.reference_step.max():.4f}",
                duration(some["median"].median()),
                duration(some.p999.max()),
                duration(some.worst.max()),
            ]
        )
    rows.sort(key=lambda row: ARMS.index(row[0]))
    return markdown_table(header, rows)


if __name__ == "__main__":
    typer.run(main)
