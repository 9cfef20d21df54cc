"""A command of several rows: each a module with SIZES, jobs, run_job and lines."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Annotated

import pandas as pd
import typer

from bench.common import commands
from bench.common.campaign import Campaign, dask_client
from bench.common.digests import core_digest
from bench.ik.experiment import tell
from bench.ik.lines import report


def measure(
    title: str,
    rows: Mapping[str, ModuleType],
    only: Sequence[str] | None,
    out: Path,
    *,
    quick: bool,
    seed: int,
    scheduler: str | None,
    workers: int,
    sizes: Mapping[str, int | None] | None = None,
    kept: Callable[[str, pd.DataFrame], object] = lambda name, trials: None,
) -> None:
    """Measure the rows, and make the table after each.

    Args:
        title: Of the command, for the campaigns' settings.
        rows: All that there are, by name.
        only: Those that are wanted; none for all.
        out: The folder of the campaigns.
        quick: Whether rows have their small size, in a folder of their own.
        seed: Of all jobs.
        scheduler: Dask's address; None for one of this run.
        workers: Processes.
        sizes: Of rows whose size was given.
        kept: Called with each row's trials.

    Raises:
        BadParameter: There is no such row.
    """
    chosen = list(only or rows)
    if unknown := sorted(set(chosen) - rows.keys()):
        raise typer.BadParameter(f"no row {', '.join(unknown)}; there are {', '.join(rows)}")
    if quick:
        out = out.with_name(out.name + "-quick")
    found = {}
    with commands.plain_errors(), dask_client(scheduler, workers) as client:
        for name in (name for name in rows if name in chosen):
            row = rows[name]
            size = (sizes or {}).get(name) or row.SIZES[0 if quick else 1]
            settings = {"experiment": f"{title} {name}", "seed": seed, "core": core_digest()}
            campaign = Campaign(out / name, settings)
            commands.console.print(name)
            trials = campaign.run(row.run_job, row.jobs(size, seed), client, commands.console)
            kept(name, trials)
            found[name] = row.lines(trials)
            tell(out, report(found, seed), shown="\n".join(map(str, found[name])))


def command(title: str, rows: Mapping[str, ModuleType]) -> Callable[..., None]:
    """What typer runs for a command whose only options are those of `measure`."""

    def main(
        out: commands.OutFolder = commands.BUILD / title,
        quick: commands.Quick = False,
        only: Annotated[
            list[str] | None, typer.Option(help=f"A row, repeatable: {', '.join(rows)}.")
        ] = None,
        seed: commands.Seed = 0,
        scheduler: commands.Scheduler = None,
        workers: commands.Workers = 1,
    ) -> None:
        """Measure, and make the table."""
        measure(
            title, rows, only, out, quick=quick, seed=seed, scheduler=scheduler, workers=workers
        )

    return main
