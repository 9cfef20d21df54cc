"""What noise of the channels leaves in the torques of a motion."""

from __future__ import annotations

import numpy as np

from ..study.recording import FloatArray
from .carried_body import CarriedBody
from .motion import Motion
from .signals import noise_density

_FEW = 50  # samples along a motion at which inertias are looked at


def position_noise(q: FloatArray, period: float) -> FloatArray:
    """Density of white noise in positions, (n,) [rad^2/Hz]."""
    return noise_density(q, period, 0.25 / period)


def inertial_noise(motion: Motion) -> FloatArray:
    """Variance that noise of positions leaves in the inertial torques after filtering, (rows,).

    White noise of density S in q is S (2 pi f)^4 in the acceleration: its integral up to the
    cut-off times the mass matrix squared.
    """
    density = position_noise(motion.recording.q, motion.period)
    acceleration = density * (2 * np.pi) ** 4 * motion.cutoff**5 / 5
    squared = np.mean(motion.mass_matrix**2, axis=0)
    if motion.body is not None:
        squared[: motion.n] += np.diag(motion.body.rotor**2)
    return np.asarray(squared @ acceleration, dtype=np.float64)


def pose_noise(motion: Motion) -> FloatArray:
    """Variance that noise of a base's pose leaves in its rates and accelerations, (6,)."""
    pose = motion.recording.base
    if pose is None:
        return np.zeros(6)
    density = noise_density(pose, motion.period, 0.25 / motion.period)
    turns = 4.0 * np.mean(density[3:]) * (2 * np.pi) ** 2 * motion.cutoff**3 / 3
    moves = density[:3] * (2 * np.pi) ** 4 * motion.cutoff**5 / 5
    return np.concatenate([np.full(3, turns), np.full(3, np.mean(moves))])


def base_noise(motion: Motion) -> FloatArray:
    """Variance that noise of a base's IMU leaves in the torques after filtering, (rows,).

    Of a base that its pose tells of, or that stands still, none is counted.
    """
    recording, body = motion.recording, motion.body
    base = motion.base
    if base is None or not base.of_imu or not isinstance(body, CarriedBody):
        return np.zeros(motion.rows)
    assert recording.acc is not None
    assert recording.gyro is not None
    felt = noise_density(recording.acc, motion.period, 0.25 / motion.period) * motion.cutoff
    turned = noise_density(recording.gyro, motion.period, 0.25 / motion.period)
    turned = turned * (2 * np.pi) ** 2 * motion.cutoff**3 / 3
    every = max(1, len(motion.q) // _FEW)
    squared = np.mean(body.base_inertia(motion.q[::every]) ** 2, axis=0)
    return np.asarray(squared @ np.concatenate([felt, turned]), dtype=np.float64)
