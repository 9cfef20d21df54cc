"""Simulators that cannot be compared with anything: states that are no numbers, joints that run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..simulation.stepper import SimulationError
from ..study.recording import FloatArray
from ..thresholds.simulators import SimulatorThresholds
from .user_model import UserModel

if TYPE_CHECKING:
    from .experiment import Experiment

_FASTEST = 1e4  # [rad/s]


def check_states(user: UserModel, states: FloatArray, recording: str, start: float) -> None:
    """That MuJoCo did not stop, and no speed left all bounds.

    Args:
        user: whose model ran.
        states: (K, nstate) after each step.
        recording: whose commands they were.
        start: time of the run's beginning [s].

    Raises:
        SimulationError: it did; the message has joint, time and what may be changed.
    """
    model = user.model
    stopped = np.flatnonzero(~(np.diff(states[:, 0]) > 0.0))
    speeds = states[:, 1 + model.nq : 1 + model.nq + model.nv]
    odd = np.flatnonzero(~np.isfinite(states).all(axis=1) | (np.abs(speeds) > _FASTEST).any(axis=1))
    if not len(stopped) and not len(odd):
        return
    at = int(min([*stopped[:1], *odd[:1]]))
    size = np.abs(np.nan_to_num(speeds[at], nan=np.inf))
    joint = model.joint(int(model.dof_jntid[int(np.argmax(size))])).name
    raise SimulationError(
        f"{user.name} is unstable under the commands of {recording}: at"
        f" {start + (at + 1) * user.timestep:.3f} s joint {joint!r} runs away"
        f" ({size.max():.3g} rad/s). {_advice(user)}"
    )


def check_follows(experiment: Experiment, limits: SimulatorThresholds) -> None:
    """That the user's model, as it is, stays near the recordings, whatever its step.

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
                f" was measured (it moves over {span:.3g} rad). {_advice(user)}, and look whether"
                " gains are in N m/rad and axes and commands have one sign"
            )
        differs = float(np.sqrt(np.mean((truer[:, c] - shown[:, c]) ** 2)))
        if differs > limits.of_its_step * max(float(np.std(measured[:, c])), 1e-3):
            raise SimulationError(
                f"{user.name} moves joint {user.joints[k]!r} otherwise with a truer step, by"
                f" {differs:.3g} rad rms under the commands of {name}, which is more than it was"
                f" recorded to move: it is the step that is seen. {_advice(user)}"
            )


def _advice(user: UserModel) -> str:
    period = None if user.law is None else user.law.period
    held = "" if period is None else f" and the controller's period {1e3 * period:g} ms"
    return (
        f"Its timestep is {1e3 * user.timestep:g} ms{held}: try a shorter one, the integrator"
        " implicitfast, lower gains, or an armature"
    )
