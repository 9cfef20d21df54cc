"""A torque's ceiling, seen in the torque alone: a level, or a line that falls with speed.

Torques of a joint that moves pile up against its drive's limit: many samples lie within the noise
of it, hardly any beyond it and few just below. What the motion needs changes meanwhile: gravity and
inertia make up for one another, which they do on no other line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..thresholds import LimitThresholds
from .motion import Motion
from .torque_limits import occasions_of

_NO_LOADS = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0)  # over the fastest speed seen
_REACHED = (0.9, 0.95, 0.98, 0.99, 0.995, 0.999)  # quantiles at which a ceiling may lie
_ROUNDS = 4
_MOST = 8000  # samples that are looked at
_LEFT = 0.15  # numerics: of the stall torque, from which a line is looked at
_BRAKES = 0.1  # numerics: of the no-load speed, from which a drive brakes
_BELOW = 5.0  # numerics: widths of the ceiling that the band below it reaches down
_BEYOND = 1.5  # numerics: the same, from which a torque lies over it
_WIDE = 2.5  # half the width of a ceiling, in standard deviations of noise
_LEAST = 0.015  # of the level, that a ceiling is wide at least


@dataclass(frozen=True, slots=True, kw_only=True)
class Ceiling:
    """The level, falling with speed, that the torques of a joint do not exceed."""

    level: float  # at rest [N m]
    level_std: float
    no_load: float  # speed at which nothing is left [rad/s]; inf where the level is the same
    no_load_std: float
    pile: float  # samples at it over those just below, per N m
    occasions: int


@dataclass(frozen=True, slots=True, eq=False)
class _Samples:
    size: FloatArray  # of the torque, (N,)
    along: FloatArray  # speed along the torque
    parts: FloatArray  # gravity and inertia along the torque, (N, 2)
    moves: NDArray[np.bool_]
    noise: float
    period: float


def ceiling_of(motions: Sequence[Motion], j: int, limits: LimitThresholds) -> Ceiling | None:
    """The clearest ceiling of joint j's recorded torque; None where there is none."""
    samples = _samples(motions, j)
    if samples is None:
        return None
    fastest = float(np.quantile(np.abs(samples.along), 0.999))
    lines = [share * fastest for share in _NO_LOADS if fastest > limits.least_span]
    tried = (
        _ceiling(samples, no_load, reached, limits)
        for no_load in (np.inf, *lines)
        for reached in _REACHED
    )
    found = [each for each in tried if each is not None]
    return max(found, key=lambda each: each[0])[1] if found else None


def pile_at(
    ceiling: Ceiling, motions: Sequence[Motion], j: int, limits: LimitThresholds
) -> float | None:
    """Samples of joint j at a ceiling that others showed, over those just below it, per N m.

    None where torques lie beyond it: there it is none.
    """
    s = _samples(motions, j)
    if s is None:
        return 0.0
    left, use = _left(s, ceiling.no_load)
    near = max(_WIDE * s.noise, _LEAST * ceiling.level)
    below = s.size - ceiling.level * left
    count = int(np.count_nonzero(use & (np.abs(below) < near)))
    beyond = int(np.count_nonzero(use & (below > _BEYOND * near)))
    if beyond > limits.over * max(count, limits.least_piled):
        return None
    return _pile(count, _expected(below, use, near))


def _expected(below: FloatArray, use: NDArray[np.bool_], near: float) -> float:
    """Samples that a band as wide as a ceiling would hold, by those just below it."""
    just = use & (below < -near) & (below > -_BELOW * near)
    return float(np.count_nonzero(just)) / (_BELOW - 1.0)


def _pile(count: int, expected: float) -> float:
    return 0.5 * count / max(expected, 1.0)


def _samples(motions: Sequence[Motion], j: int) -> _Samples | None:
    size, along, parts, moves, noise = [], [], [], [], []
    for m in motions:
        tau = m.recording.tau
        if tau is None or m.body is None or m.rows > m.n or not np.isfinite(tau[:, j]).all():
            return None
        torque, sign = tau[:, j], np.sign(tau[:, j])
        gravity = m.tau_at_rest()[:, j]
        inertia = m.tau_without_rotor()[:, j] - gravity
        good = m.valid
        size.append(np.abs(torque)[good])
        along.append((sign * m.dq[:, j])[good])
        parts.append((sign * np.stack([gravity, inertia])).T[good])
        moves.append(~m.still[:, j][good])
        noise.append(_noise(torque[good]))
    every = sum(map(len, size)) // _MOST + 1
    return _Samples(
        np.concatenate(size)[::every],
        np.concatenate(along)[::every],
        np.concatenate(parts)[::every],
        np.concatenate(moves)[::every],
        float(np.mean(noise)),
        motions[0].period * every,
    )


def _noise(torque: FloatArray) -> float:
    """Standard deviation of white noise [N m], by second differences: slow changes cancel."""
    bend = np.diff(torque, 2)
    return 1.4826 * float(np.median(np.abs(bend))) / np.sqrt(6.0) if len(bend) else np.inf


def _ceiling(
    s: _Samples, no_load: float, reached: float, limits: LimitThresholds
) -> tuple[float, Ceiling] | None:
    """One that is at a quantile of the torques, and by how many samples it stands out."""
    left, use = _left(s, no_load)
    if np.count_nonzero(use) < limits.least_piled / max(1.0 - reached, 1e-6):
        return None
    level, at = float(np.quantile((s.size / left)[use], reached)), use
    for _ in range(_ROUNDS):
        near = max(_WIDE * s.noise, _LEAST * level)
        at = use & (np.abs(s.size - level * left) < near)
        if np.count_nonzero(at) < limits.least_piled:
            return None
        level, no_load = _line(s, at, no_load)
        left, use = _left(s, no_load)
    below = s.size - level * left
    count = int(np.count_nonzero(at))
    expected = _expected(below, use, near)
    beyond = int(np.count_nonzero(use & (below > _BEYOND * near)))
    score, pile = 0.5 * count - expected, _pile(count, expected)
    inside = at & s.moves
    varies = float(s.parts[inside].std(axis=0).max()) if inside.any() else 0.0
    occasions = occasions_of(at, s.period, limits.apart)
    clear = (
        pile >= limits.piled
        and count >= limits.least_share * len(s.size)
        and beyond <= limits.over * count
        and varies >= limits.varies * near
        and level >= limits.above_noise * near
        and occasions >= limits.least_occasions
    )
    if not clear:
        return None
    speeds = np.quantile(s.along[at], (0.05, 0.95))
    if np.ptp(speeds) < limits.falls * no_load:
        no_load = np.inf
    level, level_std, no_load, no_load_std = _figures(s, at, no_load, occasions)
    return score, Ceiling(
        level=level,
        level_std=level_std,
        no_load=no_load,
        no_load_std=no_load_std,
        pile=pile,
        occasions=occasions,
    )


def _left(s: _Samples, no_load: float) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Share of the level that is left at each speed, and samples that show it is there."""
    left = 1.0 - s.along / no_load
    use = left > _LEFT
    if np.isfinite(no_load):
        use &= s.along > -_BRAKES * no_load  # a drive that brakes may give more
    return np.maximum(left, _LEFT), use


def _line(s: _Samples, at: NDArray[np.bool_], no_load: float) -> tuple[float, float]:
    """Level and no-load speed by the samples near a line; a level alone stays alone."""
    size, along = s.size[at], s.along[at]
    if not np.isfinite(no_load):
        return float(np.median(size)), no_load
    away = along - along.mean()
    fall = float(away @ size) / max(float(away @ away), 1e-300)
    level = float(size.mean()) - fall * float(along.mean())
    if fall >= 0.0 or level <= 0.0:
        return float(np.median(size / np.maximum(1.0 - along / no_load, _LEFT))), no_load
    return level, -level / fall


def _figures(
    s: _Samples, at: NDArray[np.bool_], no_load: float, occasions: int
) -> tuple[float, float, float, float]:
    """Level and no-load speed with errors, by the samples at the ceiling."""
    size, along = s.size[at], s.along[at]
    if not np.isfinite(no_load):
        level = float(np.median(size))
        return (
            level,
            float(np.hypot(np.std(size) / np.sqrt(occasions), _LEAST * level)),
            np.inf,
            0.0,
        )
    A = np.stack([np.ones(len(size)), -along], axis=1)
    (level, fall), *_ = np.linalg.lstsq(A, size, rcond=None)
    fall = max(float(fall), 1e-9 * float(level))
    spread = float(np.std(size - A @ (level, fall)))
    errors = np.sqrt(np.diag(np.linalg.pinv(A.T @ A)) * len(size) / occasions) * spread
    level_std = float(np.hypot(errors[0], _LEAST * level))
    share = float(np.hypot(errors[1] / fall, level_std / level))
    return float(level), level_std, float(level) / fall, float(level) / fall * share
