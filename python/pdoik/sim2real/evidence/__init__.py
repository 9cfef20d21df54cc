"""What a report shows of an examination, and the files that go with it.

Comes in: `Examination`. Goes out: `ReportData`, model.json and the improved model.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..export.export import export_mjcf, export_urdf
from ..model.model import FILE_NAME, Model
from ..regression.improved_model import improved_model
from ..simulation.description import read_description
from ..study.recording import FloatArray

if TYPE_CHECKING:
    from ..infer.conclude import Examination
    from ..report.data import ReportData

__all__ = ["evidence_of", "files_of", "model_of", "write"]

Tell = Callable[[str, str, float], None]


def evidence_of(
    examination: Examination, *, quick: bool = False, tell: Tell | None = None
) -> ReportData:
    """Residuals, hypotheses, replays and the cut-off's influence, as a report shows them.

    Args:
        examination: of `examine`.
        quick: leave out the replays and the cut-off's influence.
        tell: called as that of `diagnose`.
    """
    from ..report.data import Replay, ReportData
    from .cutoff_influence import cutoff_influence
    from .hypotheses import hypotheses_of
    from .replays import replays_of
    from .traces import channel_notes, slides, traces_of, units_of

    say = tell or (lambda stage, text, share: None)
    prepared = examination.prepared
    replays: tuple[Replay, ...] = ()
    notes, cutoff = channel_notes(examination), None
    if not quick:
        say("replay", "simulating what was held out, before and after", 0.88)
        replays, more = replays_of(examination, model_of(examination))
        notes += more
        say("cut-off", "the same findings with other filters", 0.93)
        cutoff = cutoff_influence(examination)
    study = prepared.study
    return ReportData(
        title=study.folder.resolve().name,
        joints=study.joints,
        units=units_of(examination),
        noise_floor=_floors(examination),
        recordings=traces_of(examination),
        position_units=tuple("m" if slides(prepared, j) else "rad" for j in range(prepared.fit.n)),
        residual_of="torque" if prepared.fit.motions[0].source else "position",
        split=study.split,
        hypotheses=hypotheses_of(examination),
        replays=replays,
        cutoff=cutoff,
        events=tuple(
            (name, *finding.window)
            for finding in examination.diagnosis.findings
            if finding.window is not None
            for name in finding.recordings
        ),
        notes=notes,
    )


def _floors(examination: Examination) -> FloatArray:
    return np.array([each.noise_floor for each in examination.diagnosis.joints.values()])


def model_of(examination: Examination) -> Model:
    """The study's robot with the findings, and with its inertias as far as the study trusts none.

    Raises:
        LoadError: the robot's file cannot be read.
    """
    return improved_model(
        examination.prepared, examination.diagnosis.findings, examination.state.fit
    )


def files_of(examination: Examination) -> dict[str, str | bytes]:
    """model.json, and the improved model in the user's formats where there was one, by name."""
    model = model_of(examination)
    files: dict[str, str | bytes] = {FILE_NAME: model.to_json()}
    if model.robot is None:
        return files
    files["improved.xml"] = export_mjcf(model).text
    if read_description(model.robot).format == "urdf":
        files["improved.urdf"] = export_urdf(model).text
    return files


def write(folder: str | Path, examination: Examination, *, quick: bool = False) -> Path:
    """Write the report, diagnosis.json, model.json and the improved model; the page's path.

    Args:
        folder: made if it is not there; files of the same names are replaced.
        examination: of `examine`.
        quick: as `evidence_of` has it.
    """
    from ..report import write_report

    evidence = evidence_of(examination, quick=quick)
    return write_report(Path(folder), examination.diagnosis, evidence, files_of(examination))
