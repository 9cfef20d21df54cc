"""Hard scenes: this library and the peers users would pick, on the same targets in the same run.

    python -m bench.ik.hard --ycb DIR --out build/bench/hard

Seven families of scenes (bench/ik/hard/scenes.py), whole poses to 1e-4 m and rad, one second each.
Peers whose packages are missing are skipped with a line. Results are kept as they come, and the
same command continues where it was stopped. --quick is a two-minute version.
"""

from typing import Annotated

import numpy as np
import pandas as pd
import typer

from bench.common import commands
from bench.common.grouped import grouped_table, mean, time_at
from bench.common.intervals import duration, share
from bench.ik.experiment import ARMS, blocks, tell
from bench.ik.hard.scenes import FAMILIES
from bench.ik.hard.trials import TOLERANCE, run_block
from bench.ik.methods import PEERS
from bench.ik.methods.available import available

BLOCK = 10  # problems of a job
SLOW = ("ik_LM", "Drake SNOPT", "mink")
OURS = ("pdoik", "pdoik, L-BFGS", "PDO-IK, omega = 0")


def main(
    ycb: commands.YcbFolder = None,
    out: commands.OutFolder = commands.BUILD / "hard",
    quick: commands.Quick = False,
    problems: Annotated[int, typer.Option(min=1, help="Per arm and family.")] = 200,
    slow_problems: Annotated[
        int, typer.Option(min=0, help="The same for peers called from Python.")
    ] = 50,
    method: Annotated[
        list[str] | None, typer.Option(help="Compare these only; repeatable, pdoik among them.")
    ] = None,
    repeats: Annotated[
        int, typer.Option(min=1, help="Solve each problem with this many seeds of a method.")
    ] = 1,
    max_time: Annotated[float, typer.Option(help="Of one solve [s].")] = 1.0,
    seed: commands.Seed = 0,
    build: commands.BuildFolder = commands.BUILD,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
) -> None:
    """Compare on hard scenes."""
    if quick:
        problems, slow_problems, out = 10, 3, out.with_name(out.name + "-quick")
    with commands.plain_errors():
        names, libraries = available(method or (*OURS, *PEERS), build)
        methods = [
            (name, min(problems, slow_problems) if name in SLOW else problems) for name in names
        ]
        settings = {
            "experiment": "hard",
            "ycb": commands.setting_of(ycb),
            "slow_problems": slow_problems,
            "methods": names,
            "libraries": libraries,
            "max_time": max_time,
            "repeats": repeats,
            "seed": seed,
        }
        common = {**settings, "methods": methods}
        jobs = blocks(problems, BLOCK, common, family=FAMILIES, robot=ARMS)
        trials = commands.run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = commands.source_of(ycb)
    intro = f"{TOLERANCE:g} m and rad, {max_time:g} s. Seed {seed}. The camera sees: {source}."
    table = hard_table(trials)
    tell(out, f"{intro}\n\n{table}", table)
    if (trials.method.isin(OURS) & trials.claimed & ~trials.confirmed).any():
        raise typer.Exit(1)


def hard_table(trials: pd.DataFrame) -> str:
    """One row per family, arm and method; ratios are to pdoik on the same problems."""
    key = ["robot", "family", "index"]
    ours = trials[trials.method == "pdoik"].groupby(key).time

    def ratio(quantile: float) -> object:
        def cell(some: pd.DataFrame) -> str:
            same = pd.concat([ours.get_group(each) for each in some.groupby(key).groups])
            value = some.time.quantile(quantile) / same.quantile(quantile)
            return f"{value:.2f}" if value < 10 else f"{value:.0f}"

        return cell

    return grouped_table(
        trials,
        {"family": "family", "robot": "arm", "method": "method"},
        {
            "n": len,
            "solved [95%]": lambda some: share(some.solved),
            "median": time_at(0.5),
            "p95": time_at(0.95),
            "max": lambda some: duration(some.time.max()),
            "median x": ratio(0.5),
            "p95 x": ratio(0.95),
            "restarts": mean("restarts", 1),
            "false claims": lambda some: np.sum(some.claimed & ~some.confirmed),
            "solved, but meshes touch": lambda some: np.sum(
                some.solved & (some.mesh_collision != "")
            ),
        },
        order={"family": FAMILIES, "robot": ARMS},
    )


if __name__ == "__main__":
    typer.run(main)
