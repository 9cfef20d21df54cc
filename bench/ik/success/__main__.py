"""The paper's first experiment: success, failures and time of IK methods among objects.

    python -m bench.ik.success --ycb DIR --out build/bench/success

Three arms, 1 to 9 objects, 200 scenarios each; results are kept as they come, and the same command
continues where it was stopped. --quick is a two-minute version.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

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
    write_report,
)
from bench.ik.experiment import ARMS
from bench.ik.methods import PAPER_METHODS
from bench.ik.success.report import (
    draw,
    full_table,
    points_table,
    speed_ratios,
    success_table,
    summary_table,
)
from bench.ik.success.trials import run_block

LEAF = 0.1  # [m]
TOLERANCE = 0.01  # [m] and [rad]
MAX_TIME = 60.0  # [s]
BLOCK = 10  # scenarios of a job
SLOW = ("R-TR", "R-CG")
WITH_TIP_X = ("PDO-IK", "PDO-IK, omega = 0", "pdoik", "Angle-LBFGS-B", "Slack-LBFGS")


def main(
    ycb: YcbFolder = None,
    out: OutFolder = BUILD / "success",
    quick: Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm and number of objects.")] = 200,
    slow_scenarios: Annotated[
        int, typer.Option(min=0, help="The same for R-TR and R-CG, which take long.")
    ] = 200,
    most_objects: Annotated[int, typer.Option(min=1, max=9)] = 9,
    seed: Seed = 0,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Repeat the paper's first experiment."""
    counts = range(1, most_objects + 1)
    if quick:
        counts, scenarios, slow_scenarios = (1, 5, 9), 10, 3  # type: ignore[assignment]
        out = out.with_name(out.name + "-quick")
    settings = {
        "experiment": "success",
        "ycb": setting_of(ycb),
        "slow_scenarios": slow_scenarios,
        "seed": seed,
        "leaf": LEAF,
        "tolerance": TOLERANCE,
        "max_time": MAX_TIME,
    }
    methods = [
        (name, "z", min(scenarios, slow_scenarios) if name in SLOW else scenarios)
        for name in PAPER_METHODS
    ] + [(name, "x", scenarios) for name in WITH_TIP_X]
    jobs = {
        f"{robot}-{count}-{first:04d}": {
            **settings,
            "robot": robot,
            "n_objects": count,
            "first": first,
            "count": min(BLOCK, scenarios - first),
            "methods": methods,
        }
        for first in range(0, scenarios, BLOCK)
        for count in counts
        for robot in ARMS
    }
    with plain_errors():
        trials = run_campaign(out, settings, run_block, jobs, scheduler, workers)
    report(trials, out, settings)


def report(trials: pd.DataFrame, out: Path, settings: dict[str, Any]) -> None:
    """Write tables.md and the figures into `out`, and print the summary."""
    source = "YCB scans" if settings["ycb"] else "shapes made from primitives (no --ycb given)"
    tip_z, tip_x = (trials[trials.axis == axis] for axis in "zx")
    slow = [name for name in PAPER_METHODS if name in SLOW and name in set(tip_z.method)]
    sections = [
        f"Objects: {source}. Seed {settings['seed']}, leaf {settings['leaf']} m.",
        "## Summary\n\n" + summary_table(tip_z),
        "## Success by number of obstacles\n\n" + success_table(tip_z),
        "## Points in the cloud\n\n" + points_table(trials),
        "## Time of the others over that of PDO-IK, same scenario\n\n"
        + speed_ratios(tip_z, "PDO-IK", slow),
        "## Time of the others over that of pdoik, same scenario\n\n"
        + speed_ratios(tip_z, "pdoik", slow),
        "## Goals with the tip's x\n\n" + summary_table(tip_x),
        "## By number of obstacles\n\n" + full_table(tip_z),
    ]
    write_report(out / "tables.md", "\n\n".join(sections))
    draw(tip_z, out / "success.png", f"Sec. exp1, {source}, goals with the tip's z")
    for section in sections[:3]:
        show(section)
    console.print(f"tables and figure: {out}/tables.md, success.png; trials: trials.parquet")


if __name__ == "__main__":
    typer.run(main)
