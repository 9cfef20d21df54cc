"""The paper's first experiment: success, failures and time of IK methods among objects.

    python -m bench.ik.success --ycb DIR --out build/bench/success

Three arms, 1 to 9 objects, 200 scenarios each; results are kept as they come, and the same command
continues where it was stopped. --quick is a two-minute version.
"""

from typing import Annotated

import typer

from bench.common import commands
from bench.ik.experiment import ARMS, blocks, tell
from bench.ik.methods import PAPER_METHODS
from bench.ik.success import report
from bench.ik.success.trials import run_block

BLOCK = 10  # scenarios of a job
SLOW = ("R-TR", "R-CG")
WITH_TIP_X = ("PDO-IK", "PDO-IK, omega = 0", "pdoik", "Angle-LBFGS-B", "Slack-LBFGS")


def main(
    ycb: commands.YcbFolder = None,
    out: commands.OutFolder = commands.BUILD / "success",
    quick: commands.Quick = False,
    scenarios: Annotated[int, typer.Option(min=1, help="Per arm and number of objects.")] = 200,
    slow_scenarios: Annotated[
        int, typer.Option(min=0, help="The same for R-TR and R-CG, which take long.")
    ] = 200,
    most_objects: Annotated[int, typer.Option(min=1, max=9)] = 9,
    method: Annotated[
        list[str] | None,
        typer.Option(help="These only, with the tip's z; repeatable, any of bench.ik.methods."),
    ] = None,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = None,
) -> None:
    """Repeat the paper's first experiment."""
    counts = list(range(1, most_objects + 1))
    if quick:
        counts, scenarios, slow_scenarios = [1, 5, 9], 10, 3
        out = out.with_name(out.name + "-quick")
    settings = {
        "experiment": "success",
        "ycb": commands.setting_of(ycb),
        "slow_scenarios": slow_scenarios,
        "seed": seed,
        "leaf": 0.1,  # [m]
        "tolerance": 0.01,  # [m] and [rad]
        "max_time": 60.0,  # [s]
    }
    if method:
        settings["only"] = sorted(method)
    methods = [
        (name, "z", min(scenarios, slow_scenarios) if name in SLOW else scenarios)
        for name in method or PAPER_METHODS
    ] + [(name, "x", scenarios) for name in ([] if method else WITH_TIP_X)]
    common = {**settings, "methods": methods}
    jobs = blocks(scenarios, BLOCK, common, n_objects=counts, robot=ARMS)
    with commands.plain_errors():
        trials = commands.run_campaign(out, settings, run_block, jobs, scheduler, workers)
    source = commands.source_of(ycb)
    tip_z, tip_x = (trials[trials.axis == axis] for axis in "zx")
    slow = [name for name in SLOW if name in set(tip_z.method)]
    sections = [
        f"Objects: {source}. Seed {seed}, leaf {settings['leaf']} m.",
        "## Summary\n\n" + report.summary_table(tip_z),
        "## Success by number of obstacles\n\n" + report.success_table(tip_z),
        "## Points in the cloud\n\n" + report.points_table(trials),
        *(
            f"## Time of the others over that of {ours}, same scenario\n\n"
            + report.speed_ratios(tip_z, ours, slow)
            for ours in ("PDO-IK", "pdoik")
            if slow
        ),
        *(["## Goals with the tip's x\n\n" + report.summary_table(tip_x)] if len(tip_x) else []),
        "## By number of obstacles\n\n" + report.full_table(tip_z),
    ]
    report.draw(tip_z, out / "success.png", f"Sec. exp1, {source}, goals with the tip's z")
    tell(out, "\n\n".join(sections), "\n\n".join(sections[:3]), also=", success.png")


if __name__ == "__main__":
    typer.run(main)
