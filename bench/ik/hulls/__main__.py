"""What hulls leave uncovered and what they waste, against their number and their cost.

    python -m bench.ik.hulls --ycb DIR --out build/bench/hulls

Scenarios of the paper's first experiment with nine objects, solved by the default method for the
tip's position and z. Every reported success is judged on the meshes; every scene has a solution by
the meshes, so one without a success is lost to the hulls, to the cloud's radii or to the solver.
Finding the covers takes some minutes per arm, once.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import matplotlib as mpl
import pandas as pd
import typer

import pdoik
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
from bench.common.intervals import duration, share
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_whole
from bench.ik.experiment import ARMS, Arm
from bench.ik.hulls.fits import hull_stages
from bench.ik.hulls.trials import BASE_LEFT_OUT, CLOUDS, HULLS, OBJECTS, SHIPPED, run_block

mpl.use("agg")
import matplotlib.pyplot as plt

BLOCK = 10


def main(
    ycb: YcbFolder = None,
    out: OutFolder = BUILD / "hulls",
    quick: Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm.")] = 200,
    seed: Seed = 1,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Find how many hulls are worth having."""
    hulls = HULLS
    if quick:
        scenarios, hulls, out = 10, (SHIPPED, BASE_LEFT_OUT), out.with_name(out.name + "-quick")
    settings = {
        "experiment": "hulls",
        "ycb": setting_of(ycb),
        "seed": seed,
        "hulls": list(hulls),
        "clouds": [list(cloud) for cloud in CLOUDS],
        "shipped": {robot: pdoik.Robot.builtin(robot).occupancy.to_yaml() for robot in ARMS},
    }
    with plain_errors():
        if not quick:
            with console.status("fitting hulls, which takes some minutes per arm the first time"):
                for robot in ARMS:
                    hull_stages(Arm.builtin(robot), out / "fits")
        jobs = {
            f"{robot}-{first:04d}": {
                "robot": robot,
                "first": first,
                "count": min(BLOCK, scenarios - first),
                "seed": seed,
                "hulls": list(hulls),
                "ycb": settings["ycb"],
                "fits": str(out / "fits"),
            }
            for first in range(0, scenarios, BLOCK)
            for robot in ARMS
        }
        trials = run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = source_of(ycb)
    table = hull_table(trials)
    write_report(out / "tables.md", f"Objects: {source}. Seed {seed}.\n\n{table}")
    draw(trials, out / "hulls.png", f"{OBJECTS} objects, {source}, default method")
    show(table)
    console.print(f"tables and figure: {out}/tables.md, hulls.png; trials: trials.parquet")


def hull_table(trials: pd.DataFrame) -> str:
    """One row per arm, cloud and occupancy."""
    header = ["arm", "leaf [m]", "radii", "most per link", "hulls", "points", "n"]
    header += ["solved", "lost [95%]", "of them base", "meshes touch [95%]", "median", "p95"]
    rows = []
    keys = ["robot", "leaf", "radii", "growth", "hulls"]
    for (robot, leaf, radii, growth, hulls), some in trials.groupby(keys, sort=False):
        solved = some[some.solved]
        kind = radius_kind(radii, growth)
        rows.append(
            [
                robot,
                f"{leaf:g}",
                kind,
                hulls,
                some.n_hulls.iloc[0],
                f"{some.n_points.mean():.0f}",
                len(some),
                f"{some.solved.mean():.3f}",
                share(~some.solved),
                f"{(some.status == 'base_collision').mean():.3f}",
                share(solved.collision != ""),
                duration(some.time.median()),
                duration(some.time.quantile(0.95)),
            ]
        )
    return markdown_table(header, rows)


def radius_kind(radii: bool, growth: float) -> str:
    """What the points' radii are, in words."""
    length = f"{1e3 * growth:g} mm" if growth else ""
    return " + ".join(filter(None, ["covering" if radii else "", length])) or "none"


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """Collisions, lost scenes and time against the number of hulls, a line per cloud."""
    figure, axes = plt.subplots(3, len(ARMS), figsize=(4 * len(ARMS), 8), squeeze=False)
    for column, robot in enumerate(ARMS):
        for leaf, radii, growth in CLOUDS:
            some = trials[
                (trials.robot == robot)
                & (trials.leaf == leaf)
                & (trials.radii == radii)
                & (trials.growth == growth)
                & (trials.hulls != BASE_LEFT_OUT)
            ]
            label = f"leaf {leaf:g} m, radii: {radius_kind(radii, growth)}"
            groups = some.groupby("n_hulls")
            touching = groups.apply(lambda g: (g.collision != "").sum() / max(g.solved.sum(), 1))
            lost = groups.solved.apply(lambda s: 1 - s.mean())
            time = groups.time.median() * 1e6
            style = {"marker": "." if radii else "x", "linestyle": "-" if radii else "--"}
            axes[0][column].plot(touching.index, touching, label=label, **style)
            axes[1][column].plot(lost.index, lost, **style)
            axes[2][column].semilogy(time.index, time, **style)
        axes[0][column].set_title(robot)
        axes[2][column].set_xlabel("hulls of the arm")
    for row, label in enumerate(
        ("successes whose meshes touch", "solvable scenes lost", "median time [us]")
    ):
        axes[row][0].set_ylabel(label)
        for ax in axes[row]:
            ax.grid(alpha=0.3)
    handles, names = axes[0][0].get_legend_handles_labels()
    figure.legend(
        handles, names, loc="upper center", ncol=4, bbox_to_anchor=(0.5, 0.97), fontsize=8
    )
    figure.suptitle(title, fontsize=10)
    figure.tight_layout(rect=(0, 0, 1, 0.91))
    write_whole(path, lambda file: figure.savefig(file, dpi=110))
    plt.close(figure)


if __name__ == "__main__":
    typer.run(main)
