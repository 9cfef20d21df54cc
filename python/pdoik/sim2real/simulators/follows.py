"""Simulators that cannot be compared with anything: joints that leave, or show only a step."""

from __future__ import annotations

import numpy as np

from ..simulation import SimulationError
from ..thresholds import SimulatorThresholds
from .experiment import Experiment
from .stability import advice


def check_follows(experiment: Experiment, limits: SimulatorThresholds) -> None:
    """Check that the user's model, as it is, stays near the recordings, whatever its step.

    Raises:
        SimulationError: a joint leaves its recorded range by far, or moves otherwise with a truer
            step by more than it moves at all.
    """
    user, measured = experiment.user, experiment.measured
    shown, truer = experiment.run({}, as_it_is=True), experiment.run({})
    for c, (channel, k) in enumerate(experiment.channels):
        if channel != "q":
            continue
        span = float(np.ptp(measured[:, c]))
        away = np.abs(shown[:, c] - measured[:, c])
        worst = int(np.argmax(away))
        name = experiment.recordings[int(experiment.recording[worst])].name
        if away[worst] > max(2.0 * np.pi, limits.runs_away * span):
            raise SimulationError(
                f"{user.name} runs away under the commands of {name}: less than 2 s after the"
                f" measured state joint {user.joints[k]!r} is {away[worst]:.3g} rad from where it"
                f" was measured (it moves over {span:.3g} rad). {advice(user)}, and look whether"
                " gains are in N m/rad and axes and commands have one sign"
            )
        differs = float(np.sqrt(np.mean((truer[:, c] - shown[:, c]) ** 2)))
        if differs > limits.of_its_step * max(float(np.std(measured[:, c])), 1e-3):
            raise SimulationError(
                f"{user.name} moves joint {user.joints[k]!r} otherwise with a truer step, by"
                f" {differs:.3g} rad rms under the commands of {name}, which is more than it was"
                f" recorded to move: it is the step that is seen. {advice(user)}"
            )
