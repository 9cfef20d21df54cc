"""How finely recordings are looked at, and minutes of an hour: more says nothing new."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdoik.recordings import Recording

from ..thresholds import NoiseThresholds
from .split import part
from .study import Study

ROWS = 3.0
"""Rows of a balance for each period of its cut-off."""


def highest_cutoff(limits: NoiseThresholds, rate: float) -> float:
    """The highest cut-off of balances [Hz] for recordings sampled at `rate` [Hz]."""
    return min(limits.highest_cutoff, limits.cutoff_of_rate * rate)


_PIECE = 30.0  # about the length of an excerpt [s]


def excerpted(study: Study) -> Study:
    """The study with as much of its recordings as a diagnosis looks at, and a note of what that is.

    The same study where it is short enough.
    """
    limits = study.thresholds.noise
    kept: list[Recording] = []
    notes: list[str] = []
    for role in dict.fromkeys(recording.role for recording in study.recordings):
        every = [each for each in study.recordings if each.role == role]
        whole = sum(map(_length, every))
        most = _most(study, every) * (1.0 if role == "fit" else limits.judged_share)
        if whole <= most:
            kept += every
            continue
        kept += [piece for each in every for piece in _pieces(each, most / whole)]
        said = "to fit" if role == "fit" else "held out"
        notes.append(
            f"Of {whole / 60:.0f} minutes of recordings {said}, {most / 60:.0f} are used, spread"
            " evenly over all of them."
        )
    if not notes:
        return study
    return replace(study, recordings=tuple(kept), notes=(*study.notes, *notes))


def _most(study: Study, recordings: Sequence[Recording]) -> float:
    """Time of so many rows as a search bears, which are a few for each period of the cut-off."""
    limits = study.thresholds.noise
    rate = 1.0 / float(np.median([recording.period for recording in recordings]))
    rows = ROWS * highest_cutoff(limits, rate) * len(study.joints)  # every second
    return float(np.clip(limits.most_rows / rows, limits.shortest, limits.longest))


def _length(recording: Recording) -> float:
    return float(recording.time[-1] - recording.time[0])


def _pieces(recording: Recording, share: float) -> list[Recording]:
    """Excerpts of a recording, a share of it together, evenly spread."""
    length = _length(recording)
    count = max(1, round(share * length / _PIECE))
    samples = len(recording.time)
    size, apart = int(share * samples / count), samples / count
    found = []
    for k in range(count):
        first = int(k * apart + (apart - size) / 2)
        piece = part(recording, first, min(first + size, samples))
        begin, end = recording.time[first], recording.time[min(first + size, samples) - 1]
        found.append(
            replace(
                piece,
                name=f"{recording.name} ({begin:.0f} to {end:.0f} s)",
                file=recording.file or recording.name,
            )
        )
    return found
