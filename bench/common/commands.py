"""What the commands of long experiments have in common: their options, and how they end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from rich.console import Console

from bench.common.campaign import Campaign, Job, Row, dask_client
from bench.common.peer_library import ROOT
from bench.common.provenance import provenance
from bench.common.whole_files import write_text

console = Console(width=None if sys.stdout.isatty() else 160)

BUILD = ROOT / "build" / "bench"

YcbFolder = Annotated[
    Path | None,
    typer.Option(help="Folder with the YCB objects: cloud_vertices/*.pcd and mesh/*.stl."),
]
OutFolder = Annotated[Path, typer.Option(help="Folder of the results.")]
Quick = Annotated[bool, typer.Option("--quick", help="A version that takes two minutes or less.")]
Seed = Annotated[int, typer.Option(min=0, help="Of scenes and targets.")]
BuildFolder = Annotated[Path, typer.Option(help="CMake's folder for the peers.")]
Scheduler = Annotated[
    str | None, typer.Option(help="Address of a Dask scheduler; without it, one of its own.")
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes on this machine; one per processor.")
]


def source_of(ycb: Path | None) -> str:
    """Where the objects come from, in words."""
    return "YCB scans" if ycb else "shapes made from primitives (no --ycb given)"


def setting_of(ycb: Path | None) -> str | None:
    """The folder as a campaign's settings have it."""
    return str(ycb.resolve()) if ycb else None


@contextmanager
def plain_errors() -> Iterator[None]:
    """End the command with a line and a status where something expected goes wrong."""
    errors = Console(stderr=True)
    try:
        yield
    except RuntimeError as error:
        errors.print(f"[bold red]error:[/] {error}", highlight=False, soft_wrap=True)
        raise typer.Exit(1) from error
    except KeyboardInterrupt:
        errors.print("stopped; the same command goes on from here")
        raise typer.Exit(130) from None


def run_campaign(
    out: Path,
    settings: Mapping[str, Any],
    function: Callable[[Job], list[Row]],
    jobs: Mapping[str, Job],
    scheduler: str | None,
    workers: int | None,
) -> pd.DataFrame:
    """All rows of all jobs, run where their results are not in `out` yet."""
    campaign = Campaign(out, settings)
    with dask_client(scheduler, workers) as client:
        return campaign.run(function, jobs, client, console)


def write_report(file: Path, text: str, more: Mapping[str, object] | None = None) -> None:
    """How and where it was measured, then the text.

    Args:
        file: bench.common.publish takes its tables into a README.
        text: Headings and tables.
        more: Facts besides those of the machine.
    """
    facts = {"command": _command(), **provenance(BUILD), **(more or {})}
    lines = "\n".join(f"- {name}: {value}" for name, value in facts.items())
    write_text(file, f"{lines}\n\n{text}")


def _command() -> str:
    """As it was typed, folders apart, which are of one machine."""
    words = sys.orig_argv[1:]
    return " ".join(["python", *("DIR" if Path(word).is_absolute() else word for word in words)])


def show(text: str) -> None:
    """Print text as it is."""
    console.print(text, highlight=False, soft_wrap=True, markup=False)
