"""Simulators that cannot be compared with anything: states that are no numbers, or too fast."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..simulation import SimulationError
from .user_model import UserModel

_FASTEST = 1e4  # numerics: [rad/s]


def check_states(user: UserModel, states: FloatArray, recording: str, start: float) -> None:
    """Check that MuJoCo did not stop, and no speed left all bounds.

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
        f" ({size.max():.3g} rad/s). {advice(user)}"
    )


def advice(user: UserModel) -> str:
    """What may be changed of a simulator whose step is too long for it."""
    period = None if user.law is None else user.law.period
    ticks = "" if period is None else f" and the controller's period {1e3 * period:g} ms"
    return (
        f"Its timestep is {1e3 * user.timestep:g} ms{ticks}: try a shorter one, the integrator"
        " implicitfast, lower gains, or an armature"
    )
