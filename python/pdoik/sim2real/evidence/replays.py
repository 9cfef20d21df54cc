"""Simulations of held-out recordings, with and without the findings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pdoik.errors import PdoikError
from pdoik.recordings import Recording

from ..model import Model, simulator_in
from ..report import Replay
from ..simulation import OPEN_LOOP_WINDOW, SHIFTED, TURNED, DrivenBy
from ..study import Setup, part

if TYPE_CHECKING:
    from ..infer import Examination

MOST = 3
LONGEST = 60.0  # of a recording [s]


def replays_of(
    examination: Examination, model: Model
) -> tuple[tuple[Replay, ...], tuple[str, ...]]:
    """Replays, at most three, and notes on what was assumed or could not be simulated."""
    study = examination.prepared.study
    if model.robot is None:
        return (), ("Nothing was replayed: the study has no robot.",)
    replays: list[Replay] = []
    notes = [f"Not in the replay: {reason}." for reason in model.not_simulated]
    for recording in (study.validate or study.fit)[:MOST]:
        try:
            setup = study.setup_of(recording)
            replays.append(replay_of(model, setup, recording, notes))
        except (PdoikError, ValueError) as error:
            notes.append(f"No replay of {recording.name}: {error}.")
    return tuple(replays), tuple(dict.fromkeys(notes))


def replay_of(model: Model, setup: Setup, recording: Recording, notes: list[str]) -> Replay:
    """A recording's first minute simulated with and without the findings.

    Args:
        model: with the findings.
        setup: how the recording was made.
        recording: of the study.
        notes: what was assumed is added to them.

    Raises:
        PdoikError, ValueError: it cannot be simulated.
    """
    recording = _shortened(recording)
    runs, strayed = [], []
    for findings in (False, True):
        simulator = simulator_in(model, setup, findings=findings)
        drive = simulator.drive_for(recording)
        window = None if drive == "controller" else OPEN_LOOP_WINDOW
        run = simulator.replay(
            recording, drive=drive, window=window, tip=False, drift_reset=window is not None
        )
        strayed.append(simulator.put_back)
        notes += [
            f"Replay {'with' if findings else 'without'} findings: {n}." for n in run.notes[1:]
        ]
        runs.append(run)
    return Replay(
        recording=recording.name,
        time=recording.time,
        recorded=np.asarray(recording.q),
        before=runs[0].q,
        after=runs[1].q,
        how=_how(drive, strayed),
        horizon=window and recording.period * max(1, round(window / recording.period)),
    )


def _how(drive: DrivenBy, strayed: Sequence[Mapping[str, int]]) -> str:
    """How it was simulated, and which joints strayed before and after the findings."""
    if drive == "controller":
        return "closed-loop simulation for the recorded commands"
    torque = "reported torque" if drive == "tau" else "commanded torque"
    how = (
        f"open-loop simulation, driven by the {torque}, put back to the recorded state every"
        f" {OPEN_LOOP_WINDOW:g} s, since no controller and commands are known"
    )
    if any(strayed):
        before, after = (_counted(each) for each in strayed)
        how += (
            f"; a joint that strayed by {TURNED:g} rad or {SHIFTED:g} m was put back at once"
            f" (before: {before}; after: {after})"
        )
    return how


def _counted(strayed: Mapping[str, int]) -> str:
    """The joint that strayed most often, and how many others did."""
    if not strayed:
        return "none"
    joint = max(strayed, key=strayed.__getitem__)
    others = f" and {len(strayed) - 1} others" if len(strayed) > 1 else ""
    return f"{joint} {strayed[joint]:,} times{others}"


def _shortened(recording: Recording) -> Recording:
    count = int(LONGEST / recording.period) + 1
    return recording if len(recording.time) <= count else part(recording, 0, count)
