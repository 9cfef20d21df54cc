"""Command line: worlds like machines, made and sealed, diagnosed blind, scored.

    python -m bench.sim2real.machines --out build/bench/machines --seed 2000000 --count 200
    python -m bench.sim2real.machines --out build/bench/machines-dev --seed 0 --count 20

Stages: conceal, diagnose, score. Each goes on where it was stopped. Another tool may be run on the
same worlds: what was said is kept by the tool's digest.
"""

from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import Scheduler, Workers, plain_errors
from bench.sim2real.frame.sealed import Stage
from bench.sim2real.machines.stages import run_of


def main(
    out: Annotated[Path, typer.Option(help="Folder of the run; about 5 MB a world.")],
    seed: Annotated[int, typer.Option(min=0, help="First seed; the proof's begin at 2000000.")] = 0,
    count: Annotated[int, typer.Option(min=1, help="Worlds.")] = 20,
    scheduler: Scheduler = None,
    workers: Workers = None,
    only: Annotated[list[Stage] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
) -> None:
    """Conceal, seal, diagnose blind, score."""
    run = run_of(out.resolve(), seed, count, scheduler=scheduler, workers=workers)
    with plain_errors():
        run.run(only)


if __name__ == "__main__":
    typer.run(main)
