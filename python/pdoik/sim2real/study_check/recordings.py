"""What was logged in a recording, and how evenly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pdoik.recordings import Recording

from ..study import Study


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingCheck:
    """What one recording has, or the part of one that is fitted or held out."""

    name: str
    role: Literal["fit", "validate"]
    channels: tuple[str, ...]
    rate: float  # of the file [Hz]
    jitter: float  # standard deviation of its time steps, as a share of their median
    length: float  # [s]
    gaps: int
    longest_gap: float  # [s]
    lost: float  # share of the samples that lie in gaps
    session: str
    notes: tuple[str, ...]  # what was repaired, in words


def recording_check(study: Study, recording: Recording) -> RecordingCheck:
    """The channels, rate, gaps and notes of a recording of the study."""
    lost = np.concatenate([[False], ~recording.valid, [False]])
    first, last = (
        np.flatnonzero(np.diff(lost.astype(int)))[0::2],
        np.flatnonzero(np.diff(lost))[1::2],
    )
    lengths = (last - first) * recording.period
    return RecordingCheck(
        name=recording.name,
        role=recording.role,
        channels=recording.channels,
        rate=1.0 / recording.raw_period,
        jitter=recording.jitter / recording.raw_period,
        length=float(recording.time[-1] - recording.time[0]),
        gaps=len(lengths),
        longest_gap=float(lengths.max()) if len(lengths) else 0.0,
        lost=float(np.mean(~recording.valid)),
        session=study.setup_of(recording).session,
        notes=recording.notes,
    )
