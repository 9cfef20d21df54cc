"""Whether the clocks of two logs of the same commands go equally fast, and by how much not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

_WINDOWS = 8  # of what both have
_LAGS = 101  # tried of each window
_REACH = 0.1  # by which a window's shift may be another one than that of all [s]
_MOVES = 1e-4  # numerics: a command of a window, least [rad]
_RATES = 0.9 * 1.0025 ** np.arange(85)  # that are tried where commands do not agree, to 1.11
_SURE = 4.0  # numerics: standard errors from which a drift is one


@dataclass(frozen=True, slots=True, kw_only=True)
class Clocks:
    """The machine's time is the simulation's plus `shift` + `drift` * the machine's time."""

    shift: float  # [s]
    drift: float  # [s/s]


def clocks_of(machine: Recording, simulation: Recording, shift: float) -> Clocks:
    """Shift and drift from windows of what both have, about a shift of all of it.

    Each window has the shift that makes its commands most alike; a line through these is the
    clocks'. A drift is none where it is within its error, or less than a sample over the log.
    """
    begin = max(machine.time[0], simulation.time[0] + shift)
    end = min(machine.time[-1], simulation.time[-1] + shift)
    found = []
    for k in range(_WINDOWS):
        low, high = (begin + (end - begin) * each / _WINDOWS for each in (k, k + 1))
        inside = (machine.time >= low) & (machine.time <= high)
        local = _local_shift(machine, simulation, inside, shift)
        if local is not None:
            found.append((0.5 * (low + high), local))
    if len(found) < 3:
        return Clocks(shift=shift, drift=0.0)
    time, shifts = np.array(found).T
    (slope, start), covariance = np.polyfit(time, shifts, 1, cov="unscaled")
    left = shifts - start - slope * time
    error = float(np.sqrt(covariance[0, 0] * (left @ left) / max(len(time) - 2, 1)))
    period = max(machine.period, simulation.period)
    if abs(slope) < _SURE * error or abs(slope) * (end - begin) < period:
        return Clocks(shift=shift, drift=0.0)
    return Clocks(shift=float(start), drift=float(slope))


def rate_between(
    machine: Recording,
    simulation: Recording,
    likeness: Callable[[Recording, Recording], tuple[float, float]],
) -> tuple[float, float]:
    """How much faster the simulation's clock goes where commands are then most alike.

    Args:
        machine: the recording.
        simulation: the simulator's log.
        likeness: shift and correlation of two recordings' commands.

    Returns:
        The ratio of its seconds to the machine's, and the correlation.
    """
    best = (1.0, 0.0)
    for rate in _RATES:
        other = _at_rate(simulation, float(rate))
        score = likeness(machine, other)[1]
        if score > best[1]:
            best = (float(rate), score)
    return best


def _at_rate(recording: Recording, rate: float) -> Recording:
    """The log as a clock would show it that goes slower by a rate, on a grid of the same period."""
    assert recording.q_des is not None
    time = np.arange(0.0, float(recording.time[-1]) / rate, recording.period)
    columns = [np.interp(time * rate, recording.time, each) for each in recording.q_des.T]
    q_des = np.stack(columns, axis=1)
    return replace(recording, time=time, q_des=q_des, q=q_des, valid=np.ones(len(time), dtype=bool))


def _local_shift(
    machine: Recording, simulation: Recording, inside: NDArray[np.bool_], shift: float
) -> float | None:
    """The shift of one window [s]; None where no command moves, or the best is at the end."""
    assert machine.q_des is not None
    wanted = machine.q_des[inside]
    if inside.sum() < 8 or np.ptp(wanted, axis=0).max() < _MOVES:
        return None
    lags = shift + np.linspace(-_REACH, _REACH, _LAGS)
    loss = np.array(
        [
            ((commands_at(simulation, machine.time[inside] - lag) - wanted) ** 2).sum()
            for lag in lags
        ]
    )
    at = int(np.argmin(loss))
    if at in (0, len(lags) - 1) or loss.max() - loss.min() < 1e-12:
        return None
    bend = loss[at - 1] - 2.0 * loss[at] + loss[at + 1]
    aside = 0.5 * (loss[at - 1] - loss[at + 1]) / bend if bend > 0.0 else 0.0
    return float(lags[at] + aside * (lags[1] - lags[0]))


def commands_at(simulation: Recording, time: FloatArray) -> FloatArray:
    """Desired positions of all joints at some times [s], on lines between samples, (T, n)."""
    assert simulation.q_des is not None
    columns = [np.interp(time, simulation.time, column) for column in simulation.q_des.T]
    return np.stack(columns, axis=1)
