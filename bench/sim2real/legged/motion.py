"""Smooth signals that motions are made of."""

from __future__ import annotations

import numpy as np

from bench.sim2real.legged.spec import Array


def sines(rng: np.random.Generator, time: Array, bands: list[tuple[float, float, float]]) -> Array:
    """A sum of sines, (T,), one for each (lowest, highest frequency [Hz], amplitude)."""
    total = np.zeros_like(time)
    for low, high, size in bands:
        f, phase = rng.uniform(low, high), rng.uniform(0.0, 2.0 * np.pi)
        total += size * rng.uniform(0.7, 1.1) * np.sin(2.0 * np.pi * f * time + phase)
    return total


def eased(time: Array, seconds: float, ramp: float = 1.5) -> Array:
    """One in the middle, smoothly zero at both ends, (T,)."""
    edge = np.clip(np.minimum(time, seconds - time) / ramp, 0.0, 1.0)
    return np.asarray(edge**3 * (10.0 - 15.0 * edge + 6.0 * edge**2))


def visits(rng: np.random.Generator, time: Array, low: float, high: float, pace: float) -> Array:
    """From value to value between low and high by quintics, with short rests, (T,)."""
    result = np.empty_like(time)
    begin, value = 0.0, float(rng.uniform(low, high))
    while begin < time[-1] + 1e-9:
        goal = float(rng.uniform(low, high))
        lasts = max(0.25, abs(goal - value) / pace * 1.875)
        rest = float(rng.choice([0.0, 0.0, 0.3]))
        s = np.clip((time - begin) / lasts, 0.0, 1.0)
        now = (time >= begin) & (time < begin + lasts + rest)
        step = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        result[now] = (value + (goal - value) * step)[now]
        begin, value = begin + lasts + rest, goal
    result[-1] = result[-2] if len(result) > 1 else result[-1]
    return result
