"""The diagnosis as a peer: `examine`, then `predict`; and the model as it was given."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bench.sim2real.proof.peers_data import Array, Track
from bench.sim2real.proof.peers_regressions import Predictor
from pdoik.sim2real import Model, Study, examine, model_of, predict


def nothing(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """The model as it was given."""
    return lambda track: track.model


@dataclass(frozen=True, slots=True, kw_only=True)
class Ours:
    """What a diagnosis found, added to the URDF that goes with a recording."""

    model: Model
    said: str  # the verdict and what was found, in words

    def __call__(self, track: Track) -> Array:
        """Torques (T, n) along a recording."""
        told = replace(self.model, robot=track.urdf.read_text(encoding="utf-8"))
        return predict(told, track.recording)


def ours(study: Study, fit: list[Track], choose: list[Track]) -> Predictor:
    """Diagnosed as it is; its validating recordings choose between findings and enter no fit."""
    examination = examine(study)
    diagnosis = examination.diagnosis
    found = [
        f"{each.effect} {' '.join((*each.joints, *each.links))}" for each in diagnosis.findings
    ]
    return Ours(model=model_of(examination), said="; ".join([diagnosis.verdict, *found]))
