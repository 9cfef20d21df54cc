"""Command line: robots with a floating base, made and sealed, diagnosed blind, scored.

    python -m bench.sim2real.legged --out build/bench/legged --seed 0 --count 92

Stages: conceal, diagnose, score. Each goes on where it was stopped. Another tool may be run on the
same worlds: what was said is kept by the tool's digest.
"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import Scheduler, Workers, plain_errors
from bench.sim2real.frame.sealed import Plan, Stage, ToolsRun
from bench.sim2real.legged import stages
from bench.sim2real.legged.spec import BACKGROUNDS, ROBOTS, specs_of

Robots = StrEnum("Robots", {name: name for name in ROBOTS})
Backgrounds = StrEnum("Backgrounds", {name: name for name in BACKGROUNDS})


def main(
    out: Annotated[Path, typer.Option(help="Folder of the run; 30 MB a world.")],
    seed: Annotated[int, typer.Option(min=0, help="First; the proof's begin at 3000000.")] = 0,
    count: Annotated[int, typer.Option(min=1)] = 92,
    robot: Annotated[list[Robots] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
    background: Annotated[list[Backgrounds] | None, typer.Option()] = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    only: Annotated[list[Stage] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
) -> None:
    """Conceal, seal, diagnose blind, score."""
    worlds = specs_of(seed, count, robot or ROBOTS, background or BACKGROUNDS)
    plan, room = Plan(seed=seed, specs=worlds), stages.__name__
    run = ToolsRun(out=out.resolve(), plan=plan, room=room, scheduler=scheduler, workers=workers)
    with plain_errors():
        run.run(only)


if __name__ == "__main__":
    typer.run(main)
