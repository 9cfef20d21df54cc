"""What noise of channels leaves in the torques of a motion, and the cut-off that it asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..study import highest_cutoff
from ..thresholds import NoiseThresholds
from .base_motion import CarriedBody
from .motion import Motion
from .rigid_body import RigidBody
from .signals import noise_density

_DEFAULT = NoiseThresholds()
_FEW = 50  # samples along a motion at which inertias are looked at


def inertial_noise(motion: Motion) -> FloatArray:
    """Variance that noise of positions leaves in the inertial torques after filtering, (rows,).

    White noise of density S in q is S (2 pi f)^4 in the acceleration: its integral up to the
    cut-off times the mass matrix squared.
    """
    density = noise_density(motion.recording.q, motion.period)
    acceleration = density * (2 * np.pi) ** 4 * motion.cutoff**5 / 5
    squared = np.mean(motion.mass_matrix**2, axis=0)
    if motion.body is not None:
        squared[: motion.n] += np.diag(motion.body.rotor**2)
    return np.asarray(squared @ acceleration, dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImuNoise:
    """Densities of white noise in an IMU and a base's pose, (6,) as the two disagree."""

    pose: FloatArray  # [rad^2/Hz] of turns, [m^2/Hz] of places
    imu: FloatArray  # [(rad/s)^2/Hz], [(m/s^2)^2/Hz]

    def band(self) -> FloatArray:
        """Frequency up to which there is something to learn [Hz], (6,).

        The pose's noise grows with frequency, once or twice differentiated: beyond where it passes
        the IMU's own, its derivatives only hide what the IMU says.
        """
        ratio = np.divide(self.imu, self.pose, out=np.full(6, np.inf), where=self.pose > 0.0)
        return np.asarray(ratio ** (0.5 / _ORDERS) / (2 * np.pi), dtype=np.float64)

    def variance(self, cutoff: float) -> FloatArray:
        """Variance of both together below a cut-off [Hz], (6,)."""
        power = 2.0 * _ORDERS + 1.0
        moved = self.pose * (2 * np.pi) ** (2.0 * _ORDERS) * cutoff**power / power
        return np.asarray(moved + self.imu * cutoff, dtype=np.float64)


_ORDERS = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # derivatives of the pose


def imu_noise(motion: Motion) -> ImuNoise:
    """The noise of a motion with a pose and an IMU."""
    recording = motion.recording
    assert recording.base is not None
    assert recording.gyro is not None
    assert recording.acc is not None
    pose = noise_density(recording.base, motion.period)
    felt = np.hstack([recording.gyro, recording.acc])
    turns, moves = 4.0 * np.mean(pose[3:]), np.mean(pose[:3])
    return ImuNoise(
        pose=np.repeat([turns, moves], 3),
        imu=noise_density(felt, motion.period),
    )


def base_noise(motion: Motion) -> FloatArray:
    """Variance that noise of a base's IMU leaves in the torques after filtering, (rows,).

    Of a base whose pose is measured, or that stands still, none is counted.
    """
    recording, body = motion.recording, motion.body
    base = motion.base
    if base is None or not base.of_imu or not isinstance(body, CarriedBody):
        return np.zeros(motion.rows)
    assert recording.acc is not None
    assert recording.gyro is not None
    felt = noise_density(recording.acc, motion.period) * motion.cutoff
    turned = noise_density(recording.gyro, motion.period)
    turned = turned * (2 * np.pi) ** 2 * motion.cutoff**3 / 3
    every = max(1, len(motion.q) // _FEW)
    squared = np.mean(body.base_inertia(motion.q[::every]) ** 2, axis=0)
    return np.asarray(squared @ np.concatenate([felt, turned]), dtype=np.float64)


def chosen_cutoff(
    recordings: Sequence[Recording],
    body: RigidBody | None,
    noise: FloatArray,
    limits: NoiseThresholds = _DEFAULT,
) -> float:
    """Cut-off of the balances [Hz].

    Positions differentiated twice have noise of density S (2 pi f)^4: at the frequency where the
    inertia times this is the torque's own noise, a wider filter lets in more noise than signal.
    """
    rate = 1.0 / max(r.period for r in recordings)
    highest = highest_cutoff(limits, rate)
    if body is None:
        return highest
    found = []
    for recording in recordings:
        if recording.tau is None:
            continue
        inertia = np.stack(
            [body.mass_diagonal(q) for q in recording.q[:: max(1, len(recording.q) // 20)]]
        )
        level = noise_density(recording.tau, recording.period)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.sqrt(level / noise) / np.mean(inertia, axis=0)
        found.extend(np.sqrt(ratio[np.isfinite(ratio)]) / (2 * np.pi))
    if not found:
        return float(min(highest, 10.0))
    return float(np.clip(np.median(found), min(limits.lowest_cutoff, highest), highest))


def noise_of(recordings: Sequence[Recording]) -> FloatArray:
    """Density of white noise in positions, the median over recordings, (n,) [rad^2/Hz]."""
    each = [noise_density(r.q, r.period) for r in recordings]
    return np.asarray(np.median(each, axis=0), dtype=np.float64)
