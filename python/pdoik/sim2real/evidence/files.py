"""Writes what an examination found, what is surest first: no failure takes the rest along."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pdoik._files import write_whole

from ..export import improved_mjcf, improved_urdf
from ..model import FILE_NAME, Model
from .gather import evidence_of, model_of
from .motions import FILE_NAME as MOTIONS
from .motions import Motions

if TYPE_CHECKING:
    from ..infer import Examination
    from ..report import ReportData

Tell = Callable[[str, str, float], None]
Files = Mapping[str, str | bytes]

DIAGNOSIS, PAGE = "diagnosis.json", "report.html"


def write(
    folder: str | Path, examination: Examination, *, quick: bool = False, tell: Tell | None = None
) -> Path:
    """Write diagnosis.json, then model.json, the improved model, motions.npz, and last the report.

    Each stands by itself: what cannot be made is left out and said in the diagnosis's notes.

    Args:
        folder: made if it is not there; files of the same names are replaced.
        examination: of `examine`.
        quick: leave out the replays and the cut-off's influence.
        tell: called as that of `diagnose`.

    Returns:
        The page, or where there is none diagnosis.json.

    Raises:
        OSError: the folder cannot be made or written to.
    """
    folder, say = Path(folder), tell or (lambda stage, text, share: None)
    diagnosis = examination.diagnosis
    page = folder / PAGE
    for name in (PAGE, MOTIONS):  # where they stand, all of it is of this diagnosis
        (folder / name).unlink(missing_ok=True)
    write_files(folder, {DIAGNOSIS: diagnosis.to_json()})
    lost: list[str] = []

    def attempt(what: str, make: Callable[[], Files]) -> None:
        try:
            files = make()
        except Exception as error:
            lost.append(f"{what} could not be made: {_words(error)}.")
            say("write", lost[-1], 0.9)
        else:
            write_files(folder, files)

    models: list[Model] = []

    def model_file() -> Files:
        models.append(model_of(examination))
        return {FILE_NAME: models[0].to_json()}

    evidences: list[ReportData] = []

    def gathered() -> Files:
        evidences.append(evidence_of(examination, quick=quick, tell=tell))
        return {}

    def motions() -> Files:
        recordings = examination.prepared.study.recordings
        return {MOTIONS: Motions.of(evidences[0], recordings).to_bytes()}

    def report() -> Files:
        from ..report import render_report

        say("report", "drawing the figures", 0.97)
        noted = replace(diagnosis, notes=(*diagnosis.notes, *lost))
        return render_report(noted, evidences[0])

    attempt(FILE_NAME, model_file)
    if models and models[0].robot is not None:
        for name, export in (("improved.xml", improved_mjcf), ("improved.urdf", improved_urdf)):
            attempt(name, lambda name=name, export=export: _exported(name, export(models[0])))  # type: ignore[misc]
    attempt("The report", gathered)
    if evidences:
        attempt(MOTIONS, motions)
        attempt("The report", report)
    if lost:
        noted = replace(diagnosis, notes=(*diagnosis.notes, *lost))
        write_files(folder, {DIAGNOSIS: noted.to_json()})
    return page if page.is_file() else folder / DIAGNOSIS


def _exported(name: str, text: str | None) -> Files:
    return {} if text is None else {name: text}


def write_files(folder: Path, files: Files) -> None:
    """Each whole or not there, in their order."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(folder / name, content)


def _words(error: Exception) -> str:
    return " ".join(str(error).split()).rstrip(".") or type(error).__name__
