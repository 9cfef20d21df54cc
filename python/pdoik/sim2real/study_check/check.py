"""What a study can show before anything is searched in it: `pdoik study check` in Python."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from threadpoolctl import threadpool_limits

from pdoik.recordings import Recording

from ..diagnose import Tell, preprocess
from ..infer import source_in_words
from ..study import Study, load_study
from ..thresholds import Thresholds
from .joints import JointCheck, joint_checks
from .visible import Visible, visible_effects


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


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyCheck:
    """What was logged, how the joints moved, and what would be seen of which effect."""

    recordings: tuple[RecordingCheck, ...]
    joints: tuple[JointCheck, ...]
    torque: str  # where it comes from, in words
    cutoff: float  # of the balances [Hz]
    effects: tuple[Visible, ...]
    notes: tuple[str, ...]  # what was repaired or found while reading, in words
    unanswerable: str  # why nothing can be found, in words; "" where something may be

    def of(self, effect: str, joint: str | None = None) -> tuple[Visible, ...]:
        """What is said of an effect, at one joint, at the base for "", or anywhere for None."""
        return tuple(
            each for each in self.effects if each.effect == effect and joint in (None, each.joint)
        )


def check_study(
    study: Study | str | os.PathLike[str],
    *,
    tell: Tell | None = None,
    thresholds: Thresholds | None = None,
) -> StudyCheck:
    """Read a study as `diagnose` does, and say what could be found in it.

    The smallest size of an effect is the one that would be found in nine of ten such recordings,
    by the thresholds of the search: its columns along the recorded motion, filtered as the balances
    are, are compared with what friction, offsets, rotors and bodies leave of the balances.

    Args:
        study: a study, or its YAML file.
        tell: called with a stage's name, what it found in words, and the share of the work done.
        thresholds: what is believed; the study's own, which are the defaults, if none are given.

    Raises:
        LoadError, ValueError: the study cannot be used; the message says what was expected.
    """
    say = tell or (lambda stage, text, share: None)
    loaded = load_study(study)
    if thresholds is not None:
        loaded = replace(loaded, thresholds=thresholds)
    with threadpool_limits(limits=1, user_api="blas"):
        ready = preprocess(loaded, say)
        prepared = ready.prepared
        return StudyCheck(
            recordings=tuple(recording_check(loaded, each) for each in loaded.recordings),
            joints=joint_checks(prepared),
            torque=source_in_words(prepared),
            cutoff=prepared.cutoff,
            effects=visible_effects(prepared, say),
            notes=(*loaded.notes, *ready.control.notes, *ready.check.notes),
            unanswerable=ready.unanswerable,
        )
