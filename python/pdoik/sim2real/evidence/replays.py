"""Simulations of held-out recordings, with and without the findings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pdoik.errors import PdoikError

from ..model.model import Model
from ..model.of_recording import simulator_in
from ..report.data import Replay
from ..study.recording import Recording
from ..study.split import part
from ..study.study import Setup

if TYPE_CHECKING:
    from ..infer.conclude import Examination

MOST = 3
LONGEST = 60.0  # of a recording [s]


def replays_of(
    examination: Examination, model: Model
) -> tuple[tuple[Replay, ...], tuple[str, ...]]:
    """At most three, and notes on what was assumed or could not be simulated."""
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
    runs = []
    for findings in (False, True):
        simulator = simulator_in(model, setup, findings=findings)
        drive = simulator.drive_for(recording)
        run = simulator.replay(recording, drive=drive, tip=False)
        notes += [
            f"Replay {'with' if findings else 'without'} findings: {n}." for n in run.notes[1:]
        ]
        runs.append(run)
    how = "closed-loop simulation for the recorded commands"
    if drive != "controller":
        how = (
            f"open-loop simulation, driven by the recorded {drive}, put back to the recorded state"
            " every 0.2 s, since no controller and commands are known"
        )
        if drive == "tau":
            how = how.replace("recorded tau", "reported torque")
    return Replay(
        recording=recording.name,
        time=recording.time,
        recorded=np.asarray(recording.q),
        before=runs[0].q,
        after=runs[1].q,
        how=how,
    )


def _shortened(recording: Recording) -> Recording:
    count = int(LONGEST / recording.period) + 1
    return recording if len(recording.time) <= count else part(recording, 0, count)
