"""What a Tracker promises, measured in one command; nothing is judged by the library itself.

    python -m bench.ik.safety --out build/bench/safety
    python -m bench.ik.safety --only ball --only cost

Every case is kept when it is known, and the same command goes on where it was stopped. One process
by default: deadlines are the machine's own. Steps that
fail are written to failures/, for bench.ik.soak --replay. --quick is a two-minute version.
"""

from collections.abc import Mapping
from types import ModuleType
from typing import Annotated

import typer

from bench.common import commands
from bench.common.campaign import Campaign, dask_client
from bench.ik.experiment import tell
from bench.ik.safety import (
    ball,
    carried,
    cost,
    follow,
    humanoid,
    joints,
    steps,
    unreached,
)
from bench.ik.safety.report import report
from bench.ik.soak.__main__ import core_digest, write_failures

ROWS: Mapping[str, ModuleType] = {
    "steps": steps,
    "carried": carried,
    "ball": ball,
    "cost": cost,
    "unreached": unreached,
    "humanoid": humanoid,
    "follow": follow,
    "joints": joints,
}


def main(
    out: commands.OutFolder = commands.BUILD / "safety",
    quick: commands.Quick = False,
    only: Annotated[
        list[str] | None, typer.Option(help=f"A row, repeatable: {', '.join(ROWS)}.")
    ] = None,
    number: Annotated[
        int | None, typer.Option("--steps", min=1, help="Of the row `steps`.")
    ] = None,
    cases: Annotated[
        int | None, typer.Option(min=1, help="Of the row `unreached`, which takes longest.")
    ] = None,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = 1,
) -> None:
    """Measure, and make the table."""
    chosen = list(only or ROWS)
    if unknown := sorted(set(chosen) - ROWS.keys()):
        raise typer.BadParameter(f"no row {', '.join(unknown)}; there are {', '.join(ROWS)}")
    if quick:
        out = out.with_name(out.name + "-quick")
    found = {}
    with commands.plain_errors(), dask_client(scheduler, workers) as client:
        for name in (name for name in ROWS if name in chosen):
            row = ROWS[name]
            size = row.SIZES[0 if quick else 1]
            if name == "steps":
                size = number or size
            elif name == "unreached":
                size = cases or size
            settings = {"experiment": f"safety {name}", "seed": seed, "core": core_digest()}
            campaign = Campaign(out / name, settings)
            commands.console.print(name)
            trials = campaign.run(row.run_job, row.jobs(size, seed), client, commands.console)
            write_failures(out / "failures", {name: trials})
            found[name] = row.lines(trials)
            tell(out, report(found, seed), shown="\n".join(map(str, found[name])))


if __name__ == "__main__":
    typer.run(main)
