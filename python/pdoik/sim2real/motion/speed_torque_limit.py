"""A torque's top that falls with speed: the voltage of a drive is spent on the motor's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..thresholds import LimitThresholds
from .flat_top import DEFAULT_LIMITS, Torques
from .signals import noise_density

_ROUNDS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedTorqueLimit:
    """The line that a torque keeps to while more is asked for."""

    stall_torque: float  # [N m]
    no_load_speed: float  # [rad/s]
    rows: int


def speed_torque_limit(
    torques: Sequence[Torques],
    speeds: Sequence[FloatArray],
    limits: LimitThresholds = DEFAULT_LIMITS,
) -> SpeedTorqueLimit | None:
    """The line S (1 - v / w) that torques stay at while more is asked for; None without one.

    v is the speed along the torque: negative where the drive brakes. Samples of which less is given
    than asked for, and of their neighbours too, lie on the line within noise, the line falls
    clearly over their speeds, and nothing that was given lies beyond it.

    Args:
        torques: of each recording, as `flat_top` has them.
        speeds: of the joint, (T,) each [rad/s].
        limits: when a torque is taken to be cut off.
    """
    noise = float(np.sqrt(np.mean([_variance(given, period) for given, _, _, period in torques])))
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


def _variance(given: FloatArray, period: float) -> float:
    """Variance of white noise, at the recording's rate [(N m)^2]."""
    density = float(noise_density(given[:, None], period, 0.25 / period)[0])
    return density * 0.5 / period


def _short(torques: Torques, missing: float) -> NDArray[np.bool_]:
    """Samples, with both neighbours, of which less is given than asked for, same sign; (T,)."""
    given, asked, good, _ = torques
    side = np.where(good, np.sign(asked), 0.0)
    less = side * (asked - given) > missing
    inner = np.zeros(len(side), dtype=np.bool_)
    same = (side[1:-1] == side[:-2]) & (side[1:-1] == side[2:])
    inner[1:-1] = less[1:-1] & less[:-2] & less[2:] & same
    return inner


def _picked(values: Sequence[FloatArray], at: Sequence[NDArray[np.bool_]]) -> FloatArray:
    return np.concatenate([v[a] for v, a in zip(values, at, strict=True)])
