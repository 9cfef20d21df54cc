"""Runs of a simulator and of the machine that had the same commands, and the time between them.

A pair is found by the files' names, else by the commands. Where the shift that makes the commands
alike is another one at the end than at the beginning, the logs' clocks run apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import fftconvolve

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Recording

from ..thresholds import SimulatorThresholds
from .clocks import clocks_of, commands_at, rate_between

_MOST_LAGS = 200_000  # numerics:


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair:
    """A recording of the machine and the simulator's log of the same commands."""

    machine: Recording
    simulation: Recording
    shift: float  # the machine's time is the simulation's plus this, at its beginning [s]
    drift: float  # by how much that grows per second
    likeness: float  # correlation of the commands
    by: str  # name or commands


def pairs_of(
    machine: Sequence[Recording],
    simulation: Sequence[Recording],
    joints: Sequence[str],
    limits: SimulatorThresholds,
) -> tuple[Pair, ...]:
    """A pair for each recording of the machine that has one.

    Raises:
        LoadError: commands are missing, none is shared, or clocks run apart.
    """
    for each in (*machine, *simulation):
        if each.q_des is None or not np.isfinite(each.q_des).all():
            raise LoadError(
                f"{each.name}: expected columns 'q_des.<joint>' of {', '.join(joints)}: runs are"
                f" paired by their commands; it has {', '.join(each.channels)}"
            )
    found, best = [], (0.0, machine[0], simulation[0])
    for recording in machine:
        tried = [(_aligned(recording, each), each) for each in simulation]
        named = [pair for pair in tried if _stem(pair[1]) == _stem(recording)]
        (shift, likeness), there = max(named or tried, key=lambda pair: pair[0][1])
        by = "name" if named else "commands"
        if likeness < limits.same_commands and named and len(tried) > 1:
            (shift, likeness), there = max(tried, key=lambda pair: pair[0][1])
            by = "commands"
        if likeness > best[0]:
            best = (likeness, recording, there)
        if likeness < limits.same_commands:
            continue
        clocks = clocks_of(recording, there, shift)
        if abs(clocks.drift) > limits.clocks:
            raise LoadError(_apart(recording, there, 1.0 - clocks.drift))
        found.append(
            Pair(
                machine=recording,
                simulation=there,
                shift=clocks.shift,
                drift=clocks.drift,
                likeness=likeness,
                by=by,
            )
        )
    if not found:
        likeness, recording, there = best
        rate, at_rate = rate_between(recording, there, _aligned)
        if at_rate >= limits.same_commands:
            raise LoadError(_apart(recording, there, rate))
        raise LoadError(
            "simulation and recordings share no commands: the most alike are"
            f" {recording.name} and {there.name} (correlation {likeness:.2f}, expected at least"
            f" {limits.same_commands:g}); let the simulator follow the recorded q_des"
        )
    return tuple(found)


def at_times_of(pair: Pair) -> FloatArray:
    """Times of the simulation's log at which the machine's samples are, (T,) [s]."""
    return np.asarray(pair.machine.time - pair.shift - pair.drift * pair.machine.time)


def drift_note(pair: Pair) -> str:
    """A note that the clocks of a pair run apart a little, which was allowed for."""
    return (
        f"{pair.machine.name} and {pair.simulation.name}: their clocks run apart by"
        f" {1e3 * pair.drift:.3g} ms in a second; that was allowed for."
    )


def _apart(machine: Recording, simulation: Recording, rate: float) -> str:
    """A note that a second of the simulation is not the machine's, and what to do."""
    return (
        f"{machine.name} and {simulation.name}: their clocks run apart: while the machine's shows a"
        f" second, the simulation's shows {rate:.5g} s ({1e3 * abs(rate - 1.0):.3g} ms in a second"
        " too much or too little); expected times of one rate: log the commands' own time stamps"
        " in both, and check the simulator's step and its real-time factor"
    )


def _stem(recording: Recording) -> str:
    return Path(recording.file or recording.name).stem


def _aligned(machine: Recording, simulation: Recording) -> tuple[float, float]:
    """The shift of time that makes commands most alike [s], and how alike they then are."""
    period = min(machine.period, simulation.period)
    a, b = _commands(machine, period), _commands(simulation, period)
    if len(a) + len(b) > _MOST_LAGS:
        period *= (len(a) + len(b)) / _MOST_LAGS
        a, b = _commands(machine, period), _commands(simulation, period)
    moving = (np.std(a, axis=0) > 1e-6) & (np.std(b, axis=0) > 1e-6)
    if not moving.any():
        return 0.0, 0.0
    least = max(2, min(len(a), len(b)) // 2)  # samples that two runs must share
    cross = _overlaps(np.ones(len(a)), np.ones(len(b)))
    count = np.maximum(cross, 1.0)
    score = np.zeros(len(cross))
    for k in np.flatnonzero(moving):
        x, y = a[:, k] - a[:, k].mean(), b[:, k] - b[:, k].mean()
        one, other = np.ones(len(x)), np.ones(len(y))
        sx, sy = _overlaps(x, other) / count, _overlaps(one, y) / count
        vx = _overlaps(x**2, other) / count - sx**2
        vy = _overlaps(one, y**2) / count - sy**2
        size = np.sqrt(np.maximum(vx, 0.0) * np.maximum(vy, 0.0))
        covariance = _overlaps(x, y) / count - sx * sy
        score += np.where(size > 1e-9, covariance / np.maximum(size, 1e-9), 0.0)
    score = np.where(cross >= least, score / moving.sum(), -1.0)
    best = int(np.argmax(score))
    place = float(best)
    if 0 < best < len(score) - 1:
        left, here, right = score[best - 1 : best + 2]
        bend = left - 2.0 * here + right
        if bend < 0.0:
            place += float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5))
    return (place - (len(b) - 1)) * period, float(score[best])


def _commands(recording: Recording, period: float) -> FloatArray:
    count = int(recording.time[-1] / period + 1e-6) + 1
    return commands_at(recording, np.asarray(np.arange(count) * period, dtype=np.float64))


def _overlaps(a: FloatArray, b: FloatArray) -> FloatArray:
    """Sums of products for every shift of b against a."""
    return np.asarray(fftconvolve(a, b[::-1]))
