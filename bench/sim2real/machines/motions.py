"""What the machines are asked to do: excitation, work, teleoperation, a policy's commands."""

import numpy as np

from bench.sim2real.frame.arm import Arm
from bench.sim2real.frame.motion import (
    STEP,
    Motion,
    Style,
    center,
    recording_motion,
    smoothstep,
)
from bench.sim2real.machines.figures import Array

STYLES = ("excitation", "work", "teleoperation", "policy")


def motion(arm: Arm, rng: np.random.Generator, style: str, duration: float, pace: float) -> Motion:
    """One recording's commands on a grid of 1 ms."""
    if style == "excitation":
        return recording_motion(arm, rng, ("sines", "reversals"), duration, pace, Style())
    if style == "work":
        return recording_motion(arm, rng, ("moves", "moves"), duration, pace, Style())
    if style == "teleoperation":
        return _moved(_held(_reaches(arm, rng, duration, pace), 0.01))
    if style == "policy":
        smooth = recording_motion(arm, rng, ("sines", "moves"), duration, pace, Style()).q
        return _policy(smooth, rng, float(rng.choice([0.02, 0.033])))
    raise ValueError(f"style is {style!r}, expected one of {', '.join(STYLES)}")


def _reaches(arm: Arm, rng: np.random.Generator, duration: float, pace: float) -> Array:
    """A hand's minimum-jerk reaches, overlapping, with pauses and a tremor of 8 to 11 Hz."""
    middle, half = center(arm, rng)
    rows = round(duration / STEP)
    q, here, row = np.tile(middle, (rows, 1)), middle.copy(), round(0.5 / STEP)
    speed = np.minimum([0.5 * joint.speed for joint in arm.joints], 1.0) * pace
    while row < rows:
        moving = rng.random(arm.n) < 0.6
        goal = np.where(moving, middle + half * rng.uniform(-0.9, 0.9, arm.n), here)
        time = max(0.6, float(np.max(1.9 * np.abs(goal - here) / speed)) * rng.uniform(1.0, 1.4))
        s = smoothstep(np.linspace(0.0, 1.0, round(time / STEP)))
        end = min(row + len(s), rows)
        q[row:end] = here + s[: end - row, None] * (goal - here)
        q[end:] = q[end - 1]
        here = q[end - 1].copy()
        row = end + round(rng.choice([0.05, 0.2, 1.2]) * rng.uniform(0.5, 1.5) / STEP)
    time = STEP * np.arange(rows)[:, None]
    tremor = rng.uniform(2e-4, 8e-4, arm.n)
    rate = rng.uniform(8.0, 11.0, arm.n)
    return q + tremor * np.sin(2.0 * np.pi * rate * time + rng.uniform(0.0, 6.0, arm.n))


def _policy(smooth: Array, rng: np.random.Generator, period: float) -> Motion:
    """Set points at a network's rate with its noise, held in between; it tells no speed."""
    noise = rng.normal(0.0, rng.uniform(1e-3, 4e-3), smooth.shape)
    q = _held(smooth + noise, period)
    q[: round(0.2 / STEP)] = smooth[0]
    return Motion(q=q, dq=np.zeros_like(q), ddq=np.zeros_like(q))


def _held(q: Array, period: float) -> Array:
    every = max(1, round(period / STEP))
    rows = (np.arange(len(q)) // every) * every
    return np.ascontiguousarray(q[rows])


def _moved(q: Array) -> Motion:
    """With the speed that an interpolating drive makes of its set points."""
    width = 20
    kernel = np.ones(width) / width
    padded = np.pad(q, ((width, width), (0, 0)), mode="edge")
    smooth = np.apply_along_axis(np.convolve, 0, padded, kernel, mode="same")[width:-width]
    return Motion.of(smooth)
