"""A first guess of gains that nobody knows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from ..study.controller import Controller

_FREQUENCY = 5.0  # of a drive and what it moves [Hz]
_DAMPED = 0.7  # share of critical damping
_ROTOR = 5e-3  # least inertia at a joint: that of a small geared drive [kg m^2]


def guessed_law(model: Any, dof: Sequence[int]) -> Controller:
    """Gains by which each joint of a model would be a damped oscillator of a drive's usual speed.

    Args:
        model: mujoco.MjModel.
        dof: of the joints.
    """
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    inertia = np.maximum(np.diag(mass)[list(dof)], _ROTOR)
    omega = 2.0 * np.pi * _FREQUENCY
    return Controller(
        kp=inertia * omega**2, kd=2.0 * _DAMPED * inertia * omega, gravity_compensation=False
    )
