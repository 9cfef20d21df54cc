"""Command line of the worlds.

    python -m bench.sim2real.legged make --robot go2 --kind payload --background plain --out DIR

writes the study to DIR/studies/NAME and its answer to DIR/truth/NAME.json;

    python -m bench.sim2real.legged bench --out build/bench/legged --seed 0 --count 92

makes worlds, diagnoses them blind and says how many causes were named at their place.
"""

import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import Scheduler, Workers, plain_errors, show, write_report
from bench.sim2real.legged.build import make_study
from bench.sim2real.legged.campaign import run
from bench.sim2real.legged.score import tables
from bench.sim2real.legged.spec import BACKGROUNDS, HEALTHY, KINDS, ROBOTS, draw, plan

app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__)

Robots = StrEnum("Robots", {name: name for name in ROBOTS})
Backgrounds = StrEnum("Backgrounds", {name: name for name in BACKGROUNDS})
Kinds = StrEnum("Kinds", {name: name for name in (HEALTHY, *KINDS)})


@app.callback()
def worlds() -> None:
    """Robots with a floating base that have something concealed."""


@app.command()
def make(
    out: Annotated[Path, typer.Option(help="Folder of studies/ and truth/.")],
    seed: Annotated[int, typer.Option(min=0)] = 0,
    count: Annotated[int, typer.Option(min=1, help="Seeds from there on.")] = 1,
    robot: Annotated[Robots | None, typer.Option(help="Drawn without it.")] = None,
    background: Annotated[Backgrounds | None, typer.Option(help="Drawn without it.")] = None,
    kind: Annotated[Kinds | None, typer.Option(help="Drawn without it.")] = None,
) -> None:
    """Make worlds."""
    for each in range(seed, seed + count):
        spec = draw(each, robot, background, kind)
        begin = time.perf_counter()
        world = make_study(out / "studies" / spec.name, spec, out / "truth" / f"{spec.name}.json")
        took = time.perf_counter() - begin
        print(f"{spec.name}: {world.attempts} attempts, {took:.1f} s", flush=True)


@app.command()
def bench(
    out: Annotated[Path, typer.Option(help="Folder of worlds and results; 30 MB a world.")],
    seed: Annotated[int, typer.Option(min=0, help="First; the proof's begin at 3000000.")] = 0,
    count: Annotated[int, typer.Option(min=1)] = 92,
    robot: Annotated[list[Robots] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
    background: Annotated[list[Backgrounds] | None, typer.Option()] = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
) -> None:
    """Make worlds, diagnose them blind, score what is said."""
    specs = plan(seed, count, robot or ROBOTS, background or BACKGROUNDS)
    with plain_errors():
        text = tables(run(out.resolve(), specs, scheduler, workers))
    show(text)
    write_report(out / "legged.md", text)


if __name__ == "__main__":
    app()
