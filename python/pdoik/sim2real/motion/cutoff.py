"""The cut-off frequency of a study: where noise of positions outgrows noise of torques."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..study import highest_cutoff
from ..thresholds import NoiseThresholds
from .motion_noise import position_noise
from .rigid_body import RigidBody
from .signals import noise_density

_DEFAULT = NoiseThresholds()


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
        level = noise_density(recording.tau, recording.period, 0.25 * rate)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.sqrt(level / noise) / np.mean(inertia, axis=0)
        found.extend(np.sqrt(ratio[np.isfinite(ratio)]) / (2 * np.pi))
    if not found:
        return float(min(highest, 10.0))
    return float(np.clip(np.median(found), min(limits.lowest_cutoff, highest), highest))


def noise_of(recordings: Sequence[Recording]) -> FloatArray:
    """Density of white noise in positions, the median over recordings, (n,) [rad^2/Hz]."""
    each = [position_noise(r.q, r.period) for r in recordings]
    return np.asarray(np.median(each, axis=0), dtype=np.float64)
