"""A torque cut off while more is asked for: at a level, or at a line that falls with speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..thresholds import LimitThresholds
from .signals import noise_density

Torques = tuple[FloatArray, FloatArray, NDArray[np.bool_], float]
"""Given (T,), asked for (T,), which samples are data, and the period [s], of one recording."""

_ROUNDS = 6
_SETTLED = 1e-4  # numerics: change of the level, as a share of it, at which rounds end
_HIGHEST = 3  # numerics: the sample from the top at which the search for a level begins
_DEFAULT = LimitThresholds()


@dataclass(frozen=True, slots=True, kw_only=True)
class FlatTop:
    """A level that a torque keeps while more is asked for."""

    level: float  # [N m]
    std: float  # [N m]
    rows: tuple[int, ...]  # at the level, of each recording
    occasions: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedTorqueLimit:
    """The line that a torque keeps to while more is asked for."""

    stall_torque: float  # [N m]
    no_load_speed: float  # [rad/s]
    rows: int


def flat_top(torques: Sequence[Torques], limits: LimitThresholds = _DEFAULT) -> FlatTop | None:
    """The highest torque's level if its top is flat; None where it is not.

    Where more is asked for than the level, and before and after that sample too, what is given
    stays at the level within noise, and nowhere is it exceeded. A drive of smaller gain, or one
    that lags, is as round at its top as what it is asked for. On one occasion alone it must last
    longer, and what is asked for rise higher.
    """
    noise = _noise(torques)
    highest = [np.abs(given[good]) for given, _, good, _ in torques if good.any()]
    if not highest or not np.isfinite(noise):
        return None
    level = max(float(np.sort(each)[-_HIGHEST]) for each in highest if len(each) > _HIGHEST)
    tops: list[FloatArray] = []
    for _ in range(_ROUNDS):
        at = [_beyond(each, level, noise) for each in torques]
        tops = [np.sign(t[1][a]) * t[0][a] for t, a in zip(torques, at, strict=True)]
        if sum(map(len, tops)) < limits.least_rows:
            return None
        before, level = level, float(np.median(np.concatenate(tops)))
        if level <= 0.0:
            return None
        if abs(level - before) < _SETTLED * level:
            break
    top = np.concatenate(tops)
    more = np.concatenate([np.abs(t[1][a]) for t, a in zip(torques, at, strict=True)]) - level
    spread = float(np.sqrt(np.mean((top - level) ** 2)))
    over = sum(
        int(np.sum(each > level + max(limits.noise * noise, 2 * limits.flat * level)))
        for each in highest
    )
    occasions = sum(occasions_of(a, t[3], limits.apart) for t, a in zip(torques, at, strict=True))
    once = occasions < 2
    if spread > max(1.5 * noise, limits.flat * level) or over > limits.over * len(top):
        return None
    if spread > (limits.flatter_once if once else limits.flatter) * float(
        np.sqrt(np.mean(more**2))
    ):
        return None
    if once and len(top) < limits.least_rows_once:
        return None
    std = max(spread, noise) / np.sqrt(len(top))
    return FlatTop(level=level, std=float(std), rows=tuple(map(len, tops)), occasions=occasions)


def speed_torque_limit(
    torques: Sequence[Torques],
    speeds: Sequence[FloatArray],
    limits: LimitThresholds = _DEFAULT,
) -> SpeedTorqueLimit | None:
    """The line S (1 - v / w) that torques stay at while more is asked for; None without one.

    v is the speed along the torque: negative where the drive brakes. Samples of which less is given
    than asked for, and of their neighbours too, lie on the line within noise, the line falls
    clearly over their speeds, and nothing that was given lies beyond it.

    Args:
        torques: of each recording.
        speeds: of the joint, (T,) each [rad/s].
        limits: when a torque is taken to be cut off.
    """
    noise = _noise(torques)
    highest = max(float(np.max(np.abs(given))) for given, *_ in torques)
    if not np.isfinite(noise) or not highest > 0.0:
        return None
    missing = max(limits.noise * noise, limits.missing * highest)
    at = [_short(each, missing) for each in torques]
    sides = [np.sign(asked) for _, asked, *_ in torques]
    top = _picked([s * t[0] for s, t in zip(sides, torques, strict=True)], at)
    asked = _picked([np.abs(t[1]) for t in torques], at)
    speed = _picked([s * v for s, v in zip(sides, speeds, strict=True)], at)
    keep = np.ones(len(top), dtype=np.bool_)
    stall = slope = 0.0
    for _ in range(_ROUNDS):
        if (
            np.count_nonzero(keep) < limits.least_rows_of_line
            or np.ptp(speed[keep]) < limits.least_span
        ):
            return None
        slope, stall = np.polyfit(speed[keep], top[keep], 1)
        off = np.abs(top - stall - slope * speed)
        keep = off < max(limits.noise * noise, limits.on_line * stall, 3.0 * float(np.median(off)))
    if np.count_nonzero(keep) < limits.kept * len(top) or not (slope < 0.0 < stall):
        return None
    spread = float(np.sqrt(np.mean((top - stall - slope * speed)[keep] ** 2)))
    more = float(np.sqrt(np.mean((asked - stall - slope * speed)[keep] ** 2)))
    fall = -slope * float(np.ptp(np.quantile(speed[keep], (0.05, 0.95))))
    if spread > max(1.5 * noise, limits.on_line * stall) or spread > limits.flatter * more:
        return None
    if fall < max(limits.falls * stall, limits.falls_clearly * spread):
        return None
    beyond = 0
    for (given, _, good, _), v in zip(torques, speeds, strict=True):
        most = np.maximum(stall + slope * np.sign(given) * v, 0.0)
        beyond += int(
            np.sum(good & (np.abs(given) > most + max(limits.noise * noise, 0.04 * stall)))
        )
    if beyond > limits.over * np.count_nonzero(keep):
        return None
    fastest = max(float(np.max(np.abs(v))) for v in speeds)
    no_load = -stall / slope
    if no_load > limits.fastest * fastest:
        return None
    return SpeedTorqueLimit(
        stall_torque=float(stall), no_load_speed=float(no_load), rows=int(np.count_nonzero(keep))
    )


def _noise(torques: Sequence[Torques]) -> float:
    """Standard deviation of white noise in what was given, at the recordings' rate [N m]."""
    density = [float(noise_density(t[0][:, None], t[3])[0]) for t in torques]
    return float(np.sqrt(np.mean([d * 0.5 / t[3] for d, t in zip(density, torques, strict=True)])))


def _inner(side: FloatArray) -> NDArray[np.bool_]:
    """Samples with the same sign, not zero, as both neighbours; (T,)."""
    inner = np.zeros(len(side), dtype=np.bool_)
    inner[1:-1] = (side[1:-1] != 0) & (side[1:-1] == side[:-2]) & (side[1:-1] == side[2:])
    return inner


def _beyond(torques: Torques, level: float, noise: float) -> NDArray[np.bool_]:
    """Samples at which more is asked for, and at their neighbours with the same sign; (T,)."""
    _, asked, good, _ = torques
    least = level + max(noise, 0.01 * level)
    return _inner(np.where(good & (np.abs(asked) > least), np.sign(asked), 0.0))


def _short(torques: Torques, missing: float) -> NDArray[np.bool_]:
    """Samples, with both neighbours, of which less is given than asked for, same sign; (T,)."""
    given, asked, good, _ = torques
    side = np.where(good, np.sign(asked), 0.0)
    return _inner(np.where(side * (asked - given) > missing, side, 0.0))


def _picked(values: Sequence[FloatArray], at: Sequence[NDArray[np.bool_]]) -> FloatArray:
    return np.concatenate([v[a] for v, a in zip(values, at, strict=True)])


def occasions_of(at: NDArray[np.bool_], period: float, apart: float) -> int:
    """Number of times that `at` (T,) is True, gaps shorter than `apart` [s] not counted."""
    index = np.flatnonzero(at)
    return int(np.sum(np.diff(index) * period > apart)) + 1 if len(index) else 0
