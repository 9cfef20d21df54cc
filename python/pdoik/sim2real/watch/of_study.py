"""The floor of a study's own recordings, so that its model can be watched with at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pdoik.recordings import Recording

from ..findings import Finding
from ..model import Model
from ..study import Study
from .calibrate import calibrated


def with_floor(model: Model, study: Study) -> Model:
    """The model with the floor of the recordings held out, or else of those fitted.

    Those of the study's robot without payload count, without what happened in them. Where no
    recording serves, the model is as it was: then only a log of the healthy machine gives a floor.
    """
    for held_out, recordings in ((True, study.validate), (False, study.fit)):
        healthy = [
            _without_events(each, model.findings)
            for each in recordings
            if each.tau is not None and study.setup_of(each).is_plain
        ]
        if not healthy or model.robot is None or model.cutoff is None:
            continue
        try:
            return calibrated(model, healthy, held_out=held_out, thresholds=study.thresholds.watch)
        except ValueError:  # too short, or a joint's torques are missing
            continue
    return model


def _without_events(recording: Recording, findings: tuple[Finding, ...]) -> Recording:
    """Windows in which something acted are no data."""
    valid = recording.valid.copy()
    for finding in findings:
        names = (recording.name, recording.file)
        if finding.window is not None and any(name in finding.recordings for name in names):
            low, high = finding.window
            valid &= (recording.time < low) | (recording.time > high)
    return recording if np.array_equal(valid, recording.valid) else replace(recording, valid=valid)
