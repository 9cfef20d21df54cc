"""Close the loop between solver, machine and diagnosis, and report what it is worth.

    python -m bench.sim2real.loop --out build/bench/loop

A Panda in MuJoCo with something concealed follows paths of `pdoik` solutions among obstacles; it is
recorded and diagnosed, what was found is fed forward, and it follows other paths. Results are kept
as they come; the same command goes on where it was stopped. --quick is a two-minute version. Needs
the extras bench and sim2real.
"""

from typing import Annotated

import typer

from bench.common import commands as cli
from bench.common.digests import code_digest
from bench.sim2real.loop.hidden import HIDDEN
from bench.sim2real.loop.report import details, main_table, reach_table, write_picture
from bench.sim2real.loop.trial import run_world

ROOM = 10  # seeds between two effects
QUICK = ("coulomb_friction", "joint_offset")


def main(
    out: cli.OutFolder = cli.BUILD / "loop",
    quick: cli.Quick = False,
    seed: cli.Seed = 3000,
    worlds: Annotated[int, typer.Option(min=1, max=ROOM, help="Of each effect.")] = 3,
    paths: Annotated[int, typer.Option(min=1, help="In each world, to judge by.")] = 2,
    effects: Annotated[
        str, typer.Option(help=f"Some of {', '.join(HIDDEN)}, with commas between.")
    ] = "",
    scheduler: cli.Scheduler = None,
    workers: cli.Workers = 2,
) -> None:
    """Record, diagnose, feed forward, run again."""
    if quick:
        worlds, paths, out = 1, 1, out.with_name(out.name + "-quick")
    chosen = tuple(effects.split(",")) if effects else QUICK if quick else tuple(HIDDEN)
    unknown = [name for name in chosen if name not in HIDDEN]
    if unknown:
        raise typer.BadParameter(f"{unknown[0]} is none of them", param_hint="--effects")
    jobs = {
        f"{effect}-{k}": {
            "seed": seed + ROOM * list(HIDDEN).index(effect) + k,
            "effect": effect,
            "paths": paths,
        }
        for k in range(worlds)
        for effect in chosen
    }
    with cli.plain_errors():
        settings = {
            "experiment": "loop",
            "seed": seed,
            "paths": paths,
            "code": code_digest("concealed", "loop"),
        }
        rows = cli.run_campaign(out, settings, run_world, jobs, scheduler, workers)
    tables = f"{main_table(rows)}\n{reach_table(rows)}"
    cli.write_report(out / "loop.md", f"{tables}\n![Tip errors](loop.png)\n\n{details(rows)}")
    write_picture(rows, out / "loop.png")
    cli.show(tables)
    cli.console.print(f"tables: {out}/loop.md; picture: loop.png; runs: trials.parquet")


if __name__ == "__main__":
    typer.run(main)
