"""A torque's flat top: the highest level, held while more is asked for."""

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

_SETTLED = 1e-4  # numerics: relative change of a level that is none
_ROUNDS = 6
DEFAULT_LIMITS = LimitThresholds()


@dataclass(frozen=True, slots=True, kw_only=True)
class FlatTop:
    """A level that a torque keeps while more is asked for."""

    level: float  # [N m]
    std: float  # [N m]
    rows: tuple[int, ...]  # at the level, of each recording
    occasions: int


def flat_top(
    torques: Sequence[Torques], limits: LimitThresholds = DEFAULT_LIMITS
) -> FlatTop | None:
    """The highest torque's level if its top is flat; None where it is not.

    Where more is asked for than the level, and before and after that sample too, what is given
    stays at the level within noise, and nowhere is it exceeded. A drive of smaller gain, or one
    that lags, is as round at its top as what it is asked for. On one occasion alone it must last
    longer, and what is asked for rise higher.
    """
    noise = float(np.sqrt(np.mean([_variance(given, period) for given, _, _, period in torques])))
    highest = [np.abs(given[good]) for given, _, good, _ in torques if good.any()]
    if not highest or not np.isfinite(noise):
        return None
    level = max(float(np.partition(each, -3)[-3:].min()) for each in highest if len(each) > 3)
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


def _variance(given: FloatArray, period: float) -> float:
    """Variance of white noise, at the recording's rate [(N m)^2]."""
    density = float(noise_density(given[:, None], period, 0.25 / period)[0])
    return density * 0.5 / period


def _beyond(torques: Torques, level: float, noise: float) -> NDArray[np.bool_]:
    """Samples at which more is asked for, and at their neighbours with the same sign; (T,)."""
    _, asked, good, _ = torques
    least = level + max(noise, 0.01 * level)
    side = np.where(good, np.sign(asked) * (np.abs(asked) > least), 0.0)
    inner = np.zeros(len(side), dtype=np.bool_)
    inner[1:-1] = (side[1:-1] != 0) & (side[1:-1] == side[:-2]) & (side[1:-1] == side[2:])
    return inner


def occasions_of(at: NDArray[np.bool_], period: float, apart: float) -> int:
    """Number of times that `at` (T,) is True, gaps shorter than `apart` [s] not counted."""
    index = np.flatnonzero(at)
    return int(np.sum(np.diff(index) * period > apart)) + 1 if len(index) else 0
