"""Tracking at 1 kHz: a moving target, spheres that come close, every step from the last answer.

    .venv/bin/python bench/tracking.py --out build/bench/tracking

Each run is made from a motion that reaches every target clear of every sphere without a jump, so a
tracker can do as well. A step that a method does not solve leaves the arm where it was. --quick is
a two-minute version.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from rich.console import Console

from campaign import Campaign, CampaignError, dask_client
from experiment import ARMS
from hard import available
from intervals import duration
from markdown import markdown_table
from methods import PEERS
from peer_library import ROOT, build_peers
from scenes import SceneError
from tracking_trials import DURATION, JUMP, PERIOD, SPHERES, TOLERANCE, run_method

console = Console(width=None if sys.stdout.isatty() else 160)

OURS = ("pdoik, one start", "pdoik")


def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = ROOT
    / "build"
    / "bench"
    / "tracking",
    quick: Annotated[bool, typer.Option("--quick", help="Two runs per arm.")] = False,
    runs: Annotated[int, typer.Option(min=1, help="Per arm.")] = 10,
    slow_runs: Annotated[int, typer.Option(min=0, help="The same for Drake and mink.")] = 2,
    max_time: Annotated[float, typer.Option(help="Of one solve [s].")] = 0.1,
    seed: Annotated[int, typer.Option(min=0)] = 0,
    build: Annotated[Path, typer.Option(help="CMake's folder for the peers.")] = ROOT
    / "build"
    / "bench",
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler; without it, one of its own.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes on this machine; one per processor.")
    ] = None,
) -> None:
    """Compare at 1 kHz."""
    if quick:
        runs, slow_runs, out = 2, 0, out.with_name(out.name + "-quick")
    try:
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
        campaign = Campaign(out, settings)
        with dask_client(scheduler, workers) as client:
            trials = campaign.run(run_method, jobs, client, console)
    except (CampaignError, SceneError, RuntimeError) as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False, soft_wrap=True)
        raise typer.Exit(1) from error
    except KeyboardInterrupt:
        Console(stderr=True).print("stopped; the same command goes on from here")
        raise typer.Exit(130) from None
    steps = round(DURATION / PERIOD)
    intro = (
        f"Runs of {steps} steps, {SPHERES} spheres each, {TOLERANCE:g} m and rad. A jump is a step "
        f"of more than {JUMP:g} rad in one joint. Seed {seed}."
    )
    table = tracking_table(trials)
    (out / "tables.md").write_text(f"{intro}\n\n{table}")
    console.print(f"{intro}\n\n{table}", highlight=False, soft_wrap=True, markup=False)
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
