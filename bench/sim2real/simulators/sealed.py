"""`pdoik compare` on machines that have what its user's simulator has no words for, sealed first.

Run from the root:

    python -m bench.sim2real.simulators.sealed --out build/bench/simulators_sealed --count 44

The first seed is drawn by the system where none is given. Stages: conceal, diagnose, score, as of
every sealed run: each goes on where it was stopped.
"""

import json
import secrets
from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import BUILD, Scheduler, Workers, plain_errors
from bench.sim2real.frame.sealed import FROZEN, Plan, Stage, ToolsRun
from bench.sim2real.simulators import stages
from bench.sim2real.simulators.worlds import specs_of


def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = BUILD / "simulators_sealed",
    seed: Annotated[
        int | None, typer.Option(help="First, below 10000 for development; else drawn.")
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Pairs.")] = 44,
    scheduler: Scheduler = None,
    workers: Workers = 1,
    only: Annotated[list[Stage] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
) -> None:
    """Conceal, seal, compare blind, score."""
    out = out.resolve()
    if seed is None:
        begun = out / FROZEN
        drawn = 1_000_000 + secrets.randbelow(2**31)
        seed = json.loads(begun.read_text())["plan"]["seed"] if begun.is_file() else drawn
    plan = Plan(seed=seed, specs={spec.name: spec for spec in specs_of(seed, count)})
    room = stages.__name__
    run = ToolsRun(out=out, plan=plan, room=room, scheduler=scheduler, workers=workers)
    with plain_errors():
        run.run(only)


if __name__ == "__main__":
    typer.run(main)
