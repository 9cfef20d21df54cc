"""pdoik diagnose: where a robot's recordings and its model disagree, and what was left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from .messages import err, fail, misuse_fails, out
from .sim2real_extra import extra_needed

if TYPE_CHECKING:
    from pdoik.sim2real.findings import Diagnosis

Tell = Callable[[str, str, float], None]


def diagnose(
    study: Annotated[Path, typer.Argument(help="YAML: robot, joints, recordings.")],
    out_folder: Annotated[
        Path, typer.Option("--out", help="Folder for the report; its files are replaced.")
    ] = Path("report"),
    seed: Annotated[int, typer.Option(min=0, help="Of the bootstraps.")] = 0,
    quick: Annotated[
        bool, typer.Option("--quick", help="Without replays and the cut-off's influence.")
    ] = False,
) -> None:
    """Say where recordings and model disagree, what physics was left out, and how sure that is.

    Writes diagnosis.json as soon as it is known, then model.json, the improved model, the figures
    and report.html; what of these cannot be made is said in the diagnosis's notes. No file is ever
    half written.

    [bold]Example[/]: pdoik diagnose study.yaml --out report
    """
    if study.is_dir():
        fail(f"study {study}: is a folder, expected a YAML file")
    if not study.is_file():
        fail(f"study {study}: no such file")
    if out_folder.exists() and not out_folder.is_dir():
        fail(f"--out {out_folder}: is a file, expected a folder")
    with extra_needed("diagnose"), misuse_fails():
        from pdoik.sim2real import examine, load_study, write

        loaded = load_study(study)
        out_folder.mkdir(parents=True, exist_ok=True)
        with _story() as tell:
            examination = examine(loaded, tell=tell, seed=seed)
            path = write(out_folder, examination, quick=quick, tell=tell)
        print_diagnosis(examination.diagnosis)
    out.print(escape(str(path)), highlight=False)


@contextmanager
def _story() -> Iterator[Tell]:
    """A bar, and above it what was found out so far, line by line."""
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        console=err,
        transient=True,
        disable=not err.is_terminal,
    ) as progress:
        task = progress.add_task("", total=1.0)

        def tell(stage: str, text: str, fraction: float) -> None:
            progress.update(task, description=escape(stage), completed=min(max(fraction, 0.0), 1.0))
            if text:
                err.print(f"[bold]{escape(stage)}[/]  {escape(text)}", highlight=False)

        yield tell


def print_diagnosis(diagnosis: Diagnosis) -> None:
    """The verdict, a table of findings, a table of joints."""
    from pdoik.sim2real.report.words import VERDICTS

    out.print(f"[bold]{escape(VERDICTS[diagnosis.verdict][0])}[/]", highlight=False)
    if diagnosis.findings:
        out.print(_findings(diagnosis))
        for finding in diagnosis.findings:
            out.print(escape(finding.statement), highlight=False)
    out.print(_joints(diagnosis))


def _findings(diagnosis: Diagnosis) -> Table:
    from pdoik.sim2real.report.words import (
        effect_name,
        estimate_numbers,
        parameters_of,
        percent,
        place,
    )

    table = _table("finding", "where", "parameter")
    table.add_column("95 % interval", no_wrap=True)
    table.add_column("gain", justify="right", no_wrap=True)  # on held-out recordings
    for finding in diagnosis.findings:
        head = [effect_name(finding.effect), place(finding)]
        gain = percent(finding.evidence.validation_gain)
        if not finding.parameters:
            table.add_row(*map(escape, head), "", "", gain)
        for name, estimate in parameters_of(finding).items():
            value, low, high = estimate_numbers(estimate)
            unit = "" if estimate.unit == "-" else f" {estimate.unit}"
            cells = [*head, f"{name} {value}{unit}", f"{low} to {high}"]
            table.add_row(*map(escape, cells), gain)
            head, gain = ["", ""], ""
    return table


def _joints(diagnosis: Diagnosis) -> Table:
    from pdoik.sim2real.report.words import joint_state, number, residue_words

    table = _table("joint")
    for name in ("residual before", "after", "noise floor"):
        table.add_column(name, justify="right")
    table.add_column("unit")
    table.add_column("")
    for name, fit in diagnosis.joints.items():
        numbers = [number(value) for value in (fit.before, fit.after, fit.noise_floor)]
        table.add_row(
            *map(escape, (name, *numbers, fit.unit, residue_words(fit) or joint_state(fit)))
        )
    return table


def _table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in columns:
        table.add_column(name)
    return table
