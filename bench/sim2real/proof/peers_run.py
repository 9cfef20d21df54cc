"""Against what users would do instead, on the same folders.

    python -m bench.sim2real.proof.peers_run --out build/bench/peers

Worlds with one thing hidden in plain view; each method is fitted on a study's recordings to fit,
and predicts torques of others: held out, faster, in other poses, with another load. Results are
kept as they come, and the same command continues where it was stopped. --quick takes two studies.
Needs the extras bench, sim2real and peers; peers that are missing are left out and named.
"""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Annotated

import pandas as pd
import typer

from bench.common import commands as cli
from bench.common.digests import code_digest
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.robots import NAMES
from bench.sim2real.proof.peers_report import (
    effect_table,
    level_table,
    method_table,
    not_lowest,
    picture,
)
from bench.sim2real.proof.peers_study import METHODS, missing, run_study

EFFECTS = (
    *("coulomb_friction", "stribeck_friction", "load_dependent_friction", "payload"),
    *("link_inertial_error", "command_delay", "backlash", "joint_elasticity", "torque_gain"),
    *("torque_offset", "torque_ripple", "position_dependent_spring", "joint_offset"),
)
QUICK = ("coulomb_friction", "payload")
ROOM = 10  # seeds between two effects


def main(
    out: cli.OutFolder = cli.BUILD / "peers",
    quick: cli.Quick = False,
    seed: cli.Seed = 4000,
    studies: Annotated[int, typer.Option(min=1, max=ROOM, help="Of each effect.")] = 3,
    scheduler: cli.Scheduler = None,
    workers: cli.Workers = None,
) -> None:
    """Compare the diagnosis with what users would do instead."""
    if quick:
        studies, out = 1, out.with_name(out.name + "-quick")
    absent = missing()
    methods = [name for name in METHODS if name not in absent]
    for sentence in absent.values():
        cli.console.print(sentence)
    jobs = {
        f"{spec.seed}-{spec.effect}": {"spec": asdict(spec), "methods": methods}
        for spec in specs(seed, studies, quick)
    }
    with cli.plain_errors():
        settings = {
            "experiment": "peers",
            "seed": seed,
            "methods": methods,
            "code": code_digest("concealed", "proof"),
        }
        rows = cli.run_campaign(out, settings, run_study, jobs, scheduler, workers)
        tables = report(rows, list(absent.values()))
        cli.write_report(out / "peers.md", tables)
        cli.show(tables)
        if "gradient boosting" not in absent:
            picture(out / "black_box.png", rows, seed, quick=quick)
    cli.console.print(f"tables: {out}/peers.md; picture: black_box.png; rows: trials.parquet")


def specs(first: int, studies: int, quick: bool) -> Iterator[WorldSpec]:
    """Specs of each effect in plain view; robots take turns; a seed belongs to one study only."""
    for k in range(studies):
        for index, effect in enumerate(EFFECTS):
            if quick and effect not in QUICK:
                continue
            robot = "random3" if quick else NAMES[(3 * index + 7 * k) % len(NAMES)]
            yield WorldSpec(seed=first + ROOM * index + k, effect=effect, robot=robot)


def report(rows: pd.DataFrame, absent: list[str]) -> str:
    seen = rows[rows.seen]
    parts = [
        f"{rows.seed.nunique()} studies, of which {seen.seed.nunique()} in which the model as given"
        " misses some joint's held-out torque by more than the noise.",
        *absent,
        "### Error over that of the model as given, median [quartiles] over studies",
        method_table(seen, "ratio"),
        "### Error in units of the torque's noise, median [quartiles] over studies",
        method_table(seen, "floors"),
        "### The same, only while the joint moves at 0.05 rad/s and more",
        method_table(seen, "moving_floors"),
        "### Error in units of the noise, all joints of all studies",
        method_table(rows, "all_joints"),
        "### Share of studies in which a method is lowest or within 5 % of it",
        level_table(seen),
        "### By effect: error in units of the noise, held out (lowest and level in bold)",
        effect_table(rows, "validate"),
        "### By effect: the same, the worst of the three conditions beyond the fit",
        effect_table(rows, None),
        "### Where ours is neither lowest nor level",
        "\n".join(not_lowest(rows)) + "\n",
    ]
    return "\n\n".join(parts)


if __name__ == "__main__":
    typer.run(main)
