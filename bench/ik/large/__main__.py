"""Solves and steps among ever more shapes, triangles and points, judged by coal.

    python -m bench.ik.large --out build/bench/large
    python -m bench.ik.large --only boxes

Every case is kept when it is known, and the same command goes on where it was stopped. --quick is a
short version.
"""

from collections.abc import Mapping
from types import ModuleType
from typing import Annotated

import typer

from bench.common import commands
from bench.ik.large import boxes, meshes, points
from bench.ik.rows import measure

ROWS: Mapping[str, ModuleType] = {"boxes": boxes, "meshes": meshes, "points": points}


def main(
    out: commands.OutFolder = commands.BUILD / "large",
    quick: commands.Quick = False,
    only: Annotated[
        list[str] | None, typer.Option(help=f"A row, repeatable: {', '.join(ROWS)}.")
    ] = None,
    seed: commands.Seed = 0,
    scheduler: commands.Scheduler = None,
    workers: commands.Workers = 1,
) -> None:
    """Measure, and make the table."""
    measure("large", ROWS, only, out, quick=quick, seed=seed, scheduler=scheduler, workers=workers)


if __name__ == "__main__":
    typer.run(main)
