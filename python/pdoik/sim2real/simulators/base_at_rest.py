"""Recordings of a base that moves, which simulators of a fixed base cannot be compared with."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import Recording

from ..thresholds import SimulatorThresholds


def check_base_at_rest(recording: Recording, limits: SimulatorThresholds) -> None:
    """Check that the base was held, by its pose and its gyroscope where these were logged.

    Raises:
        ValueError: it was not.
    """
    said = []
    if recording.base is not None:
        shift = float(np.max(np.ptp(recording.base[:, :3], axis=0)))
        if shift > limits.base_shift:
            said.append(f"base.x, .y, .z change by {shift:.2g} m")
    if recording.gyro is not None:
        spin = recording.gyro - np.median(recording.gyro, axis=0)  # less what it is off by
        rms = float(np.sqrt(np.mean(np.sum(spin**2, axis=1))))
        if rms > limits.base_spin:
            said.append(f"its gyroscope turns at {rms:.2g} rad/s")
    if said:
        raise ValueError(
            f"{recording.name}: the base moves ({', '.join(said)}); pdoik compare runs simulators"
            " with the base fixed: record it hung up or clamped and leave this one out, or let"
            " pdoik diagnose judge it with the study's key 'base:'"
        )
