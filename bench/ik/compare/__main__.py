"""Compares this library with its peers and with the paper, in one run.

    python -m bench.ik.compare [--quick] [--ycb DIR] [--json results.json]

Three experiments: random reachable poses against KDL and a Levenberg-Marquardt method on Pinocchio;
the paper's cluttered scenes; and the paper's algorithm from one start, against a plain scalar
implementation of it. bench/README.md says what the columns mean.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

import pdoik
from bench.common.commands import write_report
from bench.common.peer_library import ROOT, build_peers
from bench.common.provenance import provenance
from bench.common.timings import Block
from bench.common.whole_files import write_text
from bench.ik.compare.paper import BOXES, repeat_paper
from bench.ik.compare.peers import PEERS, compare_with_peers
from bench.ik.compare.scenes import solve_scenes
from bench.ik.experiment import ARMS, Advance, Arm, Goal
from bench.ik.scenes.objects import ObjectModel, SceneError, primitive_models, ycb_models

console = Console(width=None if sys.stdout.isatty() else 160)


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A tenth of the problems.")] = False,
    robot: Annotated[list[str] | None, typer.Option(help="One of the arms; repeatable.")] = None,
    targets: Annotated[int, typer.Option(min=1, help="Per arm, without obstacles.")] = 1000,
    scenes: Annotated[int, typer.Option(min=1, help="Per arm, with obstacles.")] = 200,
    ycb: Annotated[
        Path | None, typer.Option(help="Folder with cloud_vertices/*.pcd of the YCB objects.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of targets and scenes.")] = 0,
    build: Annotated[Path, typer.Option(help="CMake's folder for the peers.")] = ROOT
    / "build"
    / "bench",
    as_json: Annotated[Path | None, typer.Option("--json", help="Write the tables there.")] = None,
    as_markdown: Annotated[
        Path | None, typer.Option("--markdown", help="Write the tables there.")
    ] = None,
) -> None:
    """Compare this library with its peers and with the paper, in one run."""
    if quick:
        targets, scenes = max(1, targets // 10), max(1, scenes // 10)
    try:
        models, source = _models(ycb)
        with console.status("building the peers"):
            libraries = build_peers(build)
        where = provenance(build)
        for name, value in where.items():
            console.print(f"[dim]{name}:[/] {value}", highlight=False)
        arms = [Arm.builtin(name) for name in robot or ARMS]
        blocks = _run(arms, libraries, models, source, targets, scenes, seed)
    except (pdoik.PdoikError, SceneError, RuntimeError, ValueError, OSError, ImportError) as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False, soft_wrap=True)
        raise typer.Exit(2) from error
    for block in blocks:
        console.print(block.table(), "")
    if as_json is not None:
        tables = [block.to_json() for block in blocks]
        write_text(as_json, json.dumps({"provenance": where, "blocks": tables}, indent=1) + "\n")
    if as_markdown is not None:
        write_report(as_markdown, "\n".join(block.to_markdown() for block in blocks))
    if any(
        row.false_claims
        for block in blocks
        for row in block.rows
        if row.method in {"pdoik", "paper"}
    ):
        raise typer.Exit(1)


def _models(ycb: Path | None) -> tuple[Sequence[ObjectModel], str]:
    if ycb is None:
        models: Sequence[ObjectModel] = primitive_models()
        return models, f"{len(models)} shapes made from primitives"
    models = ycb_models(ycb)
    return models, f"{len(models)} YCB scans"


def _run(
    arms: list[Arm],
    libraries: Path,
    models: Sequence[ObjectModel],
    source: str,
    targets: int,
    scenes: int,
    seed: int,
) -> list[Block]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as progress:

        def bar(description: str, total: int) -> Advance:
            task = progress.add_task(description, total=total)
            return lambda done: progress.advance(task, done)

        with_peers = bar("peers", targets * len(arms) * (1 + len(PEERS)))
        blocks = [compare_with_peers(arms, libraries, targets, seed, with_peers)]
        blocks.append(
            solve_scenes(arms, models, scenes, seed, source, bar("scenes", scenes * len(arms)))
        )
        repeats: tuple[tuple[Goal, int], ...] = (("pose", 0), ("axis", 0), ("axis", BOXES))
        for goal, boxes in repeats:
            count = scenes if boxes else targets
            advance = bar(f"paper, {goal}, {boxes} boxes", 2 * count * len(arms))
            blocks.append(repeat_paper(arms, libraries, goal, boxes, count, seed, advance))
    return blocks


if __name__ == "__main__":
    typer.run(main)
