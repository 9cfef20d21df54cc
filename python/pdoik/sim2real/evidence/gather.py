"""What a report shows of an examination."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pdoik.recordings import FloatArray

from ..model import Model
from ..regression import improved_model
from ..watch import with_floor

if TYPE_CHECKING:
    from ..infer import Examination
    from ..report import ReportData

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
    from ..report import Replay, ReportData
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
        try:
            replays, more = replays_of(examination, model_of(examination))
            notes += more
        except Exception as error:
            notes += (f"Nothing was replayed: {error}.",)
        say("cut-off", "the same findings with other filters", 0.93)
        try:
            cutoff = cutoff_influence(examination)
        except Exception as error:
            notes += (f"The cut-off's influence is not known: {error}.",)
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
    """The study's robot with the findings, with its inertias as far as the study trusts none.

    It knows what it leaves of the recordings' torques, for `pdoik watch`.

    Raises:
        LoadError: the robot's file cannot be read.
    """
    prepared = examination.prepared
    model = improved_model(prepared, examination.diagnosis.findings, examination.state.fit)
    return with_floor(model, prepared.study)
