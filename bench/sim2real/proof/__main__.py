"""Command line of the proof.

    python -m bench.sim2real.proof --out build/bench/proof
    python -m bench.sim2real.proof --out build/bench/proof-quick --quick

Stages: conceal, diagnose, score, machines, real. Each goes on where it was stopped. `machines` is
the second edition: worlds of bench.sim2real.machines, sealed and scored in a folder of their own.
"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import Quick, Scheduler, Workers, plain_errors
from bench.sim2real.machines import stages as machines
from bench.sim2real.proof.plan import plan
from bench.sim2real.proof.real import diagnose_real
from bench.sim2real.proof.run import Run

OWN = ("conceal", "diagnose", "score")
Stage = StrEnum("Stage", {name.upper(): name for name in (*OWN, "machines", "real")})
MACHINES = 200  # worlds of the second edition


def main(
    out: Annotated[Path, typer.Option(help="Folder of the run; about 8 MB a study.")],
    quick: Quick = False,
    seed: Annotated[
        int | None, typer.Option(min=0, help="First seed; the proof's, 1000000, without it.")
    ] = None,
    every: Annotated[int, typer.Option(min=1, help="One study in so many: development.")] = 1,
    scheduler: Scheduler = None,
    workers: Workers = None,
    recordings: Annotated[
        Path | None, typer.Option(help="Folder with recordings of real machines: real.md.")
    ] = None,
    only: Annotated[list[Stage] | None, typer.Option(help="Repeatable; all otherwise.")] = None,
) -> None:
    """Conceal, seal, diagnose blind, score."""
    stages = [stage for stage in Stage if stage in (only or Stage)]
    try:
        chosen = plan(seed, quick=quick, every=every)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    if only and Stage.REAL in stages and recordings is None:
        raise typer.BadParameter("real needs --recordings")
    out, cluster = out.resolve(), {"scheduler": scheduler, "workers": workers}
    with plain_errors():
        own = [stage for stage in stages if stage in OWN]
        proof = Run(out=out, plan=chosen, **cluster)
        if own:
            proof.freeze()
        if Stage.DIAGNOSE in own:
            proof.conceal()
        for stage in own:
            getattr(proof, stage)()
        if Stage.MACHINES in stages:
            first = machines.FIRST_PROOF_SEED if seed is None and not quick else seed or 0
            count = max(1, (10 if quick else MACHINES) // every)
            machines.run_of(out / "machines", first, count, **cluster).run()
        if recordings is not None and Stage.REAL in stages:
            diagnose_real(recordings, out)


if __name__ == "__main__":
    typer.run(main)
