"""Solves and steps among ever more shapes, triangles, cells and points, judged by others.

    python -m bench.ik.large --out build/bench/large
    python -m bench.ik.large --only boxes

Every case is kept when it is known, and the same command goes on where it was stopped. --quick is a
short version.
"""

from collections.abc import Mapping
from types import ModuleType

import typer

from bench.ik.large import boxes, fields, meshes, points
from bench.ik.rows import command

ROWS: Mapping[str, ModuleType] = {
    "boxes": boxes,
    "meshes": meshes,
    "fields": fields,
    "points": points,
}

main = command("large", ROWS)

if __name__ == "__main__":
    typer.run(main)
