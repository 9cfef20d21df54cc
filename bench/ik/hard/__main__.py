"""Hard scenes: this library and the peers users would pick, on the same targets in the same run.

    python -m bench.ik.hard --ycb DIR --out build/bench/hard

Seven families of scenes (bench/ik/hard/scenes.py), whole poses to 1e-4 m and rad, one second each.
Peers whose packages are missing are skipped with a line. Results are kept as they come, and the
same command continues where it was stopped. --quick is a two-minute version.
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
from bench.common.peer_library import build_peers
from bench.ik.experiment import ARMS
from bench.ik.hard.scenes import FAMILIES
from bench.ik.hard.trials import TOLERANCE, run_block
from bench.ik.methods import PEERS
from bench.ik.methods.available import available

BLOCK = 10  # problems of a job
SLOW = ("ik_LM", "Drake SNOPT", "mink")
OURS = ("pdoik", "pdoik, L-BFGS", "PDO-IK, omega = 0")


def main(
    ycb: YcbFolder = None,
    out: OutFolder = BUILD / "hard",
    quick: Quick = False,
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
    seed: Seed = 0,
    build: BuildFolder = BUILD,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Compare on hard scenes."""
    if quick:
        problems, slow_problems, out = 10, 3, out.with_name(out.name + "-quick")
    with plain_errors():
        with console.status("building the peers"):
            libraries = build_peers(build)
        methods = [
            (name, min(problems, slow_problems) if name in SLOW else problems)
            for name in available(method or (*OURS, *PEERS), libraries)
        ]
        settings = {
            "experiment": "hard",
            "ycb": setting_of(ycb),
            "slow_problems": slow_problems,
            "methods": [name for name, _ in methods],
            "libraries": str(libraries),
            "max_time": max_time,
            "repeats": repeats,
            "seed": seed,
        }
        jobs = {
            f"{robot}-{family.replace(' ', '_')}-{first:04d}": {
                **settings,
                "robot": robot,
                "family": family,
                "first": first,
                "count": min(BLOCK, problems - first),
                "methods": methods,
            }
            for first in range(0, problems, BLOCK)
            for family in FAMILIES
            for robot in ARMS
        }
        trials = run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = source_of(ycb)
    intro = f"{TOLERANCE:g} m and rad, {max_time:g} s. Seed {seed}. The camera sees: {source}."
    table = hard_table(trials)
    write_report(out / "tables.md", f"{intro}\n\n{table}")
    show(table)
    console.print(f"tables: {out}/tables.md; trials: trials.parquet")
    if (trials.method.isin(OURS) & trials.claimed & ~trials.confirmed).any():
        raise typer.Exit(1)


def hard_table(trials: pd.DataFrame) -> str:
    """One row per family, arm and method; ratios are to pdoik on the same problems."""
    header = ["family", "arm", "method", "n", "solved [95%]", "median", "p95", "max"]
    header += ["median x", "p95 x", "restarts", "false claims", "solved, but meshes touch"]
    key = ["robot", "family", "index"]
    ours = trials[trials.method == "pdoik"].groupby(key).time
    rows = []
    for (family, robot, method), some in trials.groupby(["family", "robot", "method"], sort=False):
        same = pd.concat([ours.get_group(each) for each in some.groupby(key).groups])
        quantiles = some.time.quantile([0.5, 0.95]).to_numpy()
        ratios = quantiles / same.quantile([0.5, 0.95]).to_numpy()
        rows.append(
            [
                family,
                robot,
                method,
                len(some),
                share(some.solved),
                *(duration(value) for value in (*quantiles, some.time.max())),
                *(f"{ratio:.2f}" if ratio < 10 else f"{ratio:.0f}" for ratio in ratios),
                f"{some.restarts.mean():.1f}",
                int((some.claimed & ~some.confirmed).sum()),
                int((some.solved & (some.mesh_collision != "")).sum()),
            ]
        )
    rows.sort(key=lambda row: (list(FAMILIES).index(row[0]), ARMS.index(row[1])))
    return markdown_table(header, rows)


if __name__ == "__main__":
    typer.run(main)
