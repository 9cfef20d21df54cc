"""pdoik diagnose: where a robot's recordings and its model disagree, and what was left out."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pdoik._extras import asks_for

from .messages import NOT_SOLVED, err, fail, misuse_fails, out
from .story import story

if TYPE_CHECKING:
    from pdoik.sim2real import Diagnosis
    from pdoik.sim2real.report import Matrix


def diagnose(
    study: Annotated[Path, typer.Argument(help="YAML: robot, joints, recordings.")],
    out_folder: Annotated[
        Path, typer.Option("--out", help="Folder for the report; its files are replaced.")
    ] = Path("report"),
    seed: Annotated[int, typer.Option(min=0, help="Of the bootstraps.")] = 0,
    quick: Annotated[
        bool, typer.Option("--quick", help="Without replays and the cut-off's influence.")
    ] = False,
    anyway: Annotated[
        bool, typer.Option("--anyway", help="Also where the study can show nothing.")
    ] = False,
) -> None:
    """Say where recordings and model disagree, what physics was left out, and how sure that is.

    A recording's entry may say what was attached (payload), other gains (controller), the day
    (session): what changes from day to day is given as a spread.

    Writes diagnosis.json as soon as it is known, then model.json, the improved model, motions.npz
    for `pdoik view`, the figures and report.html; what of these cannot be made is said in the
    diagnosis's notes. No file is ever half written. A study in which nothing can be found, as
    `pdoik study check` says it, is refused with status 1.

    [bold]Example[/]: pdoik diagnose study.yaml --out report
    """
    if study.is_dir():
        fail(f"study {study}: is a folder, expected a YAML file")
    if not study.is_file():
        fail(f"study {study}: no such file")
    if out_folder.exists() and not out_folder.is_dir():
        fail(f"--out {out_folder}: is a file, expected a folder")
    with asks_for("sim2real"), misuse_fails():
        import_module("pdoik.sim2real.report")  # what is missing is said before the work begins
        from pdoik.sim2real import UnanswerableError, examine, load_study, write

        loaded = load_study(study)
        out_folder.mkdir(parents=True, exist_ok=True)
        with story() as tell:
            try:
                examination = examine(loaded, tell=tell, seed=seed, anyway=anyway)
            except UnanswerableError as error:
                err.print(f"[bold red]refused:[/] {escape(str(error))}", highlight=False)
                err.print("--anyway runs it all the same", highlight=False)
                raise typer.Exit(NOT_SOLVED) from error
            path = write(out_folder, examination, quick=quick, tell=tell)
        print_diagnosis(examination.diagnosis)
    err.print(f"pdoik view {escape(str(out_folder))} shows the robot moving", highlight=False)
    out.print(escape(str(path)), highlight=False)


_LINES = 25  # of the summary; the page has the rest
_WIDTH = 118  # of tables where nobody looks at a terminal


def print_diagnosis(diagnosis: Diagnosis) -> None:
    """The verdict, joints by what several of them have, what is anomalous, what would decide."""
    from pdoik.sim2real.controllers import contradictions, of_load
    from pdoik.sim2real.report import (
        VERDICTS,
        changes_words,
        line,
        matrix_of,
        percent,
        suspected_words,
    )

    matrix = matrix_of(diagnosis)
    out.print(f"[bold]{escape(VERDICTS[diagnosis.verdict][0])}[/]", highlight=False)
    for estimate in diagnosis.controllers:
        for said in (*contradictions(estimate), *of_load(estimate)):
            out.print(escape(said), highlight=False)
    wide = out if out.is_terminal else Console(file=out.file, width=_WIDTH)
    wide.print(_joints(diagnosis, matrix))
    decided = next((f.decided_by for f in diagnosis.findings if f.equivalents), "")
    changed = changes_words(diagnosis)
    last = bool(decided) + bool(diagnosis.suspected) + len(changed)
    room = max(3, _LINES - len(diagnosis.joints) - 8 - last)  # 7 of them the table's
    for finding in matrix.others[:room]:
        gain = percent(finding.evidence.validation_gain)
        said = f"{line(finding)}; gain {gain}, confidence {finding.confidence:.2f}"
        out.print(escape(said), highlight=False)
    if len(matrix.others) > room:
        out.print(f"... and {len(matrix.others) - room} more findings", highlight=False)
    for line_of_changes in changed:
        out.print(escape(line_of_changes), highlight=False)
    if diagnosis.suspected:
        out.print(escape(suspected_words(diagnosis)), highlight=False)
    if decided:
        out.print(escape(f"What would decide: {decided}"), highlight=False)


def _joints(diagnosis: Diagnosis, matrix: Matrix) -> Table:
    from pdoik.sim2real.report import cell, heading, joint_state, number, residue_words

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("joint", no_wrap=True)
    for name in ("before", "after", "noise"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for effect in matrix.effects:
        table.add_column(escape(heading(effect)), justify="right", min_width=13)
    table.add_column("", min_width=16)
    for name, fit in diagnosis.joints.items():
        numbers = [number(value) for value in (fit.before, fit.after, fit.noise_floor)]
        found = [cell(matrix.cells[name].get(effect)) for effect in matrix.effects]
        state = residue_words(fit) or joint_state(fit)
        table.add_row(*map(escape, (name, *numbers, fit.unit, *found, state)))
    return table
