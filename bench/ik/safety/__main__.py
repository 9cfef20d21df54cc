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
from bench.ik.rows import measure
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
from bench.ik.soak.__main__ import write_failures

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
    failures = (out.with_name(out.name + "-quick") if quick else out) / "failures"
    measure(
        "safety",
        ROWS,
        only,
        out,
        quick=quick,
        seed=seed,
        scheduler=scheduler,
        workers=workers,
        sizes={"steps": number, "unreached": cases},
        kept=lambda name, trials: write_failures(failures, {name: trials}),
    )


if __name__ == "__main__":
    typer.run(main)
