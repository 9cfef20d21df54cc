"""The paper's second experiment: the share of targets that each method reaches to 1e-1 ... 1e-8.

    python -m bench.ik.success.precision --ycb DIR --out build/bench/precision

Scenarios as in the first experiment, UR10 and iiwa14, one and three objects. Every method runs
until it is done, not until some tolerance is met; whether an answer collides is left aside, as in
the paper.
"""

from itertools import product
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
import typer

from bench.common import commands
from bench.common.grouped import grouped_table
from bench.common.intervals import wilson
from bench.ik.experiment import blocks, tell
from bench.ik.pictures import plt, save, title_and_legend
from bench.ik.success.trials import run_block

BLOCK = 5  # scenarios of a job
ROBOTS = ("iiwa14", "ur10")
OBJECTS = (1, 3)
METHODS = ("PDO-IK", "PDO-IK, omega = 0", "pdoik", "pdoik, capsules", "R-TR", "R-CG")
FINEST = 1e-9  # no method stops for being good enough [m] and [rad]
TOLERANCES = tuple(10.0**-k for k in range(1, 9))
ERRORS = {"position_error": "position [m]", "rotation_error": "rotation [rad]"}


def main(
    ycb: commands.YcbFolder = None,
    out: commands.OutFolder = commands.BUILD / "precision",
    quick: commands.Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm and number of objects.")] = 200,
    slow_scenarios: Annotated[int, typer.Option(min=0, help="The same for R-TR and R-CG.")] = 50,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
) -> None:
    """Repeat the paper's second experiment."""
    if quick:
        scenarios, slow_scenarios, out = 20, 4, out.with_name(out.name + "-quick")
    settings = {
        "experiment": "precision",
        "ycb": commands.setting_of(ycb),
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
    common = {**settings, "methods": methods}
    jobs = blocks(scenarios, BLOCK, common, n_objects=OBJECTS, robot=ROBOTS)
    with commands.plain_errors():
        trials = commands.run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = commands.source_of(ycb)
    tables = (f"**{label}**\n\n{share_table(trials, error)}" for error, label in ERRORS.items())
    draw(trials, out / "precision.png", f"Sec. exp2, {source}")
    text = "\n\n".join([f"Objects: {source}. Seed {seed}.", *tables])
    tell(out, text, also=", precision.png")


def share_table(trials: pd.DataFrame, error: str) -> str:
    """Share of targets whose error is below each tolerance."""
    shares = {f"{t:.0e}": lambda some, t=t: f"{(some[error] < t).mean():.2f}" for t in TOLERANCES}
    keys = {"robot": "arm", "n_objects": "obstacles", "method": "method"}
    return grouped_table(trials, keys, {"n": len, **shares})


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """Share against tolerance, 95% intervals shaded: position above, rotation below."""
    cells = list(product(ROBOTS, OBJECTS))
    size = (3.6 * len(cells), 6)
    figure, axes = plt.subplots(2, len(cells), figsize=size, sharex=True, sharey=True)
    for panels, (error, label) in zip(axes, ERRORS.items(), strict=True):
        panels[0].set_ylabel(f"share within, {label}")
        for ax, (robot, count) in zip(panels, cells, strict=True):
            of_cell = trials[(trials.robot == robot) & (trials.n_objects == count)]
            for method, colour in zip(METHODS, plt.get_cmap("tab10").colors, strict=False):
                some = of_cell[of_cell.method == method]
                within = np.array([int((some[error] < t).sum()) for t in TOLERANCES])
                low, high = np.transpose([wilson(k, len(some)) for k in within])
                share = within / max(len(some), 1)
                ax.semilogx(TOLERANCES, share, ".-", color=colour, label=method)
                ax.fill_between(TOLERANCES, low, high, color=colour, alpha=0.12, linewidth=0)
            ax.grid(alpha=0.3)
            ax.set_ylim(-0.03, 1.03)
    for ax, (robot, count) in zip(axes[0], cells, strict=True):
        ax.set_title(f"{robot}, {count} obstacle{'s' if count > 1 else ''}")
    for ax in axes[1]:
        ax.set_xlabel("tolerance")
    axes[0][0].invert_xaxis()
    title_and_legend(figure, axes[0][0], title, below=0.92, legend=0.96)
    save(figure, path)


if __name__ == "__main__":
    typer.run(main)
