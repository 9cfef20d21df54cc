"""What hulls leave uncovered and what they waste, against their number and their cost.

    python -m bench.ik.hulls --ycb DIR --out build/bench/hulls

Scenarios of the paper's first experiment with nine objects, solved by the default method for the
tip's position and z. Every reported success is judged on the meshes; every scene has a solution by
the meshes, so one without a success is lost to the hulls, to the cloud's radii or to the solver.
Finding the covers takes some minutes per arm, once.
"""

from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

import pdoik
from bench.common import commands
from bench.common.grouped import grouped_table, mean, time_at
from bench.common.intervals import share
from bench.ik.experiment import ARMS, Arm, blocks, tell
from bench.ik.hulls.fits import hull_stages
from bench.ik.hulls.trials import (
    BASE_LEFT_OUT,
    CAPSULES,
    CLOUDS,
    HULLS,
    OBJECTS,
    SHIPPED,
    run_block,
)
from bench.ik.pictures import plt, save, title_and_legend

BLOCK = 10


def main(
    ycb: commands.YcbFolder = None,
    out: commands.OutFolder = commands.BUILD / "hulls",
    quick: commands.Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm.")] = 200,
    seed: commands.Seed = 1,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
) -> None:
    """Find how many hulls are worth having."""
    hulls = HULLS
    if quick:
        scenarios, hulls = 10, (SHIPPED, BASE_LEFT_OUT, CAPSULES)
        out = out.with_name(out.name + "-quick")
    common = {"ycb": commands.setting_of(ycb), "seed": seed, "hulls": list(hulls)}
    settings = {
        "experiment": "hulls",
        **common,
        "clouds": [list(cloud) for cloud in CLOUDS],
        "shipped": {robot: pdoik.Robot.builtin(robot).occupancy.to_yaml() for robot in ARMS},
    }
    with commands.plain_errors():
        if not quick:
            waiting = "fitting hulls, which takes some minutes per arm the first time"
            with commands.console.status(waiting):
                for robot in ARMS:
                    hull_stages(Arm.builtin(robot), out / "fits")
        jobs = blocks(scenarios, BLOCK, {**common, "fits": str(out / "fits")}, robot=ARMS)
        trials = commands.run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = commands.source_of(ycb)
    trials["kind"] = [radius_kind(*each) for each in zip(trials.radii, trials.growth, strict=True)]
    table = hull_table(trials)
    draw(trials, out / "hulls.png", f"{OBJECTS} objects, {source}, default method")
    tell(out, f"Objects: {source}. Seed {seed}.\n\n{table}", table, also=", hulls.png")


def radius_kind(radii: bool, growth: float) -> str:
    """What the points' radii are, in words."""
    length = f"{1e3 * growth:g} mm" if growth else ""
    return " + ".join(filter(None, ["covering" if radii else "", length])) or "none"


def hull_table(trials: pd.DataFrame) -> str:
    """One row per arm, cloud and occupancy."""
    return grouped_table(
        trials.assign(leaf=[f"{leaf:g}" for leaf in trials.leaf]),
        {"robot": "arm", "leaf": "leaf [m]", "kind": "radii", "hulls": "most per link"},
        {
            "hulls": lambda some: some.n_hulls.iloc[0],
            "points": mean("n_points", 0),
            "n": len,
            "solved": mean("solved"),
            "lost [95%]": lambda some: share(~some.solved),
            "of them base": lambda some: f"{(some.status == 'base_collision').mean():.3f}",
            "meshes touch [95%]": lambda some: share(some[some.solved].collision != ""),
            "median": time_at(0.5),
            "p95": time_at(0.95),
        },
    )


def draw(trials: pd.DataFrame, path: Path, title: str) -> None:
    """Collisions, lost scenes and time against the number of hulls, a line per cloud."""
    figure, axes = plt.subplots(3, len(ARMS), figsize=(4 * len(ARMS), 8), squeeze=False)
    counted = trials[~trials.hulls.isin([BASE_LEFT_OUT, CAPSULES])]
    for column, robot in zip(axes.T, ARMS, strict=True):
        of_arm = counted[counted.robot == robot]
        for (leaf, kind), some in of_arm.groupby(["leaf", "kind"], sort=False):
            groups = some.groupby("n_hulls")
            touching = groups.apply(lambda g: (g.collision != "").sum() / max(g.solved.sum(), 1))
            lost = groups.solved.apply(lambda s: 1 - s.mean())
            time = groups.time.median() * 1e6
            covering = some.radii.iloc[0]
            style = {"marker": "." if covering else "x", "linestyle": "-" if covering else "--"}
            column[0].plot(touching, label=f"leaf {leaf:g} m, radii: {kind}", **style)
            column[1].plot(lost, **style)
            column[2].semilogy(time, **style)
        column[0].set_title(robot)
        column[2].set_xlabel("hulls of the arm")
        for ax in column:
            ax.grid(alpha=0.3)
    labels = ("successes whose meshes touch", "solvable scenes lost", "median time [us]")
    for ax, label in zip(axes[:, 0], labels, strict=True):
        ax.set_ylabel(label)
    title_and_legend(figure, axes[0][0], title, below=0.91, legend=0.97, fontsize=8)
    save(figure, path)


if __name__ == "__main__":
    typer.run(main)
