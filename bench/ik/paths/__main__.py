"""Whole paths and the moves between, measured in one command; judged by Pinocchio, NumPy and coal.

    python -m bench.ik.paths --out build/bench/paths
    python -m bench.ik.paths --only free --only motion
    python -m bench.ik.paths --case free:ur10:turns:0:0

Every case is kept when it is known, and the same command goes on where it was stopped. --quick is a
short version. --case draws one problem again by its key, asks once and says what came of it. For
the row `peers` mink is taken if it is installed: pip install mink daqp
"""

from collections.abc import Mapping
from types import ModuleType
from typing import Annotated

import typer

from bench.common import commands
from bench.ik.paths import (
    axis,
    closed,
    free,
    gap,
    impossible,
    length,
    memory,
    motion,
    peers,
)
from bench.ik.paths.cases import told
from bench.ik.rows import measure

ROWS: Mapping[str, ModuleType] = {
    "free": free,
    "axis": axis,
    "gap": gap,
    "impossible": impossible,
    "closed": closed,
    "motion": motion,
    "memory": memory,
    "length": length,
    "peers": peers,
}


def main(
    out: commands.OutFolder = commands.BUILD / "paths",
    quick: commands.Quick = False,
    only: Annotated[
        list[str] | None, typer.Option(help=f"A row, repeatable: {', '.join(ROWS)}.")
    ] = None,
    case: Annotated[str | None, typer.Option(help="The key of one problem, instead.")] = None,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = 1,
) -> None:
    """Measure, and make the table."""
    if case is not None:
        commands.show(told(case))
        return
    measure("paths", ROWS, only, out, quick=quick, seed=seed, scheduler=scheduler, workers=workers)


if __name__ == "__main__":
    typer.run(main)
