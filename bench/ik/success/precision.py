"""The paper's second experiment: the share of targets that each method reaches to 1e-1 ... 1e-8.

    python -m bench.ik.success.precision --ycb DIR --out build/bench/precision

Scenarios as in the first experiment, UR10 and iiwa14, one and three objects. Every method runs
until it is done, not until some tolerance is met; whether an answer collides is left aside, as in
the paper.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import matplotlib as mpl
import numpy as np
import pandas as pd
import typer

from bench.common.commands import (
    BUILD,
    OutFolder,
    Quick,
    Scheduler,
    Seed,
    Workers,
    YcbFolder,
    console,
    plain_errors,
    run_campaign,
    setting_of,
    show,
    source_of,
    write_report,
)
from bench.common.intervals import wilson
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_whole
from bench.ik.success.trials import run_block

mpl.use("agg")
import matplotlib.pyplot as plt

ROBOTS = ("iiwa14", "ur10")
OBJECTS = (1, 3)
METHODS = ("PDO-IK", "PDO-IK, omega = 0", "pdoik", "pdoik, capsules", "R-TR", "R-CG")
FINEST = 1e-9  # no method stops for being good enough [m] and [rad]
TOLERANCES = tuple(10.0**-k for k in range(1, 9))
ERRORS = {"position_error": "position [m]", "rotation_error": "rotation [rad]"}


def main(
    ycb: YcbFolder = None,
    out: OutFolder = BUILD / "precision",
    quick: Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm and number of objects.")] = 200,
    slow_scenarios: Annotated[int, typer.Option(min=0, help="The same for R-TR and R-CG.")] = 50,
    seed: Seed = 0,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Repeat the paper's second experiment."""
    if quick:
        scenarios, slow_scenarios, out = 20, 4, out.with_name(out.name + "-quick")
    settings = {
        "experiment": "precision",
        "ycb": setting_of(ycb),
        "slow_scenarios": slow_scenarios,
        "seed": seed,
        "leaf": 0.1,
        "tolerance": FINEST,
        "max_time": 60.0,
    }
    methods = [
        (name, "z", min(scenarios, slow_scenarios) if name.startswith("R-") else scenarios)
        for name in METHODS
    ]
    jobs = {
        f"{robot}-{count}-{first:04d}": {
            **settings,
            "robot": robot,
            "n_objects": count,
            "first": first,
            "count": min(5, scenarios - first),
            "methods": methods,
        }
        for first in range(0, scenarios, 5)
        for count in OBJECTS
        for robot in ROBOTS
    }
    with plain_errors():
        trials = run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = source_of(ycb)
    tables = f"Objects: {source}. Seed {seed}.\n\n" + "\n\n".join(
        f"**{label}**\n\n{share_table(trials, error)}" for error, label in ERRORS.items()
    )
    write_report(out / "tables.md", tables)
    draw(trials, out / "precision.png", f"Sec. exp2, {source}")
    show(tables)
    console.print(f"tables and figure: {out}/tables.md, precision.png; trials: trials.parquet")


def share_table(trials: pd.DataFrame, error: str) -> str:
    """Share of targets whose error is below each tolerance."""
    header = ["arm", "obstacles", "method", "n", *(f"{t:.0e}" for t in TOLERANCES)]
    rows = [
        [*key, len(some), *(f"{(some[error] < t).mean():.2f}" for t in TOLERANCES)]
        for key, some in trials.groupby(["robot", "n_objects", "method"], sort=False)
    ]
    return markdown_table(header, rows)


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """Share against tolerance, 95% intervals shaded: position above, rotation below."""
    cells = [(robot, count) for robot in ROBOTS for count in OBJECTS]
    figure, axes = plt.subplots(
        2, len(cells), figsize=(3.6 * len(cells), 6), sharex=True, sharey=True
    )
    for column, (robot, count) in enumerate(cells):
        for row, (error, label) in enumerate(ERRORS.items()):
            ax = axes[row][column]
            for method, colour in zip(METHODS, plt.get_cmap("tab10").colors, strict=False):
                some = trials[
                    (trials.robot == robot)
                    & (trials.n_objects == count)
                    & (trials.method == method)
                ]
                within = [int((some[error] < t).sum()) for t in TOLERANCES]
                low, high = np.transpose([wilson(k, len(some)) for k in within])
                ax.semilogx(
                    TOLERANCES,
                    np.array(within) / max(len(some), 1),
                    ".-",
                    color=colour,
                    label=f"{method}",
                )
                ax.fill_between(TOLERANCES, low, high, color=colour, alpha=0.12, linewidth=0)
            ax.grid(alpha=0.3)
            ax.set_ylim(-0.03, 1.03)
            if row == 0:
                ax.set_title(f"{robot}, {count} obstacle{'s' if count > 1 else ''}")
            if column == 0:
                ax.set_ylabel(f"share within, {label}")
            ax.set_xlabel("tolerance" if row == 1 else "")
    axes[0][0].invert_xaxis()
    handles, names = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, names, loc="upper center", ncol=4, bbox_to_anchor=(0.5, 0.96))
    figure.suptitle(title, fontsize=10)
    figure.tight_layout(rect=(0, 0, 1, 0.92))
    write_whole(path, lambda file: figure.savefig(file, dpi=110))
    plt.close(figure)


if __name__ == "__main__":
    typer.run(main)
