"""What the recordings' operators commanded: sines, moves with rests, slow reversals."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bench.sim2real.frame.arm import Arm, Array

STEP = 1e-3  # of the commands' grid [s]
KINDS = ("sines", "moves", "reversals", "fast_moves")


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Commanded positions of one recording on a grid of 1 ms."""

    q: Array  # (K, n) [rad]
    dq: Array  # (K, n) [rad/s]
    ddq: Array  # (K, n) [rad/s^2]

    @classmethod
    def of(cls, q: Array) -> Motion:
        """Make the motion of positions (T, n), by differences."""
        dq = np.gradient(q, STEP, axis=0)
        return cls(q=q, dq=dq, ddq=np.gradient(dq, STEP, axis=0))

    @property
    def time(self) -> Array:
        """Times of the rows [s]."""
        return STEP * np.arange(len(self.q))


@dataclass(frozen=True, slots=True, kw_only=True)
class Style:
    """What a way of hiding demands of the motions."""

    still: dict[int, float] = field(default_factory=dict)  # joints that never move, and where
    slow: frozenset[int] = frozenset()  # joints that creep


def center(arm: Arm, rng: np.random.Generator) -> tuple[Array, Array]:
    """A pose and how far each joint goes from it [rad]."""
    lower, upper = arm.limits
    half = np.minimum(0.42 * (upper - lower), rng.uniform(0.8, 1.3, arm.n))
    room = np.minimum(0.5 * (upper - lower) - half, 0.6)
    return np.clip(0.5 * (lower + upper), -2.0, 2.0) + room * rng.uniform(-0.8, 0.8, arm.n), half


def recording_motion(
    arm: Arm,
    rng: np.random.Generator,
    kinds: tuple[str, ...],
    duration: float,
    pace: float,
    style: Style,
) -> Motion:
    """Segments of the given kinds one after the other, starting and ending at rest."""
    middle, half = center(arm, rng)
    rows, limits = round(duration / len(kinds) / STEP), arm.speeds
    parts = [middle + _segment(rng, kind, rows, limits, pace, half) for kind in kinds]
    q = np.concatenate(parts)
    for joint in style.slow:
        pace, reach = rng.uniform(0.04, 0.12), half[joint] * rng.uniform(0.1, 0.3)
        q[:, joint] = middle[joint] + _triangle(len(q), pace, reach, rng.uniform(0.0, 1.0))
    for joint, position in style.still.items():
        q[:, joint] = position
    return Motion.of(smoothed(q))


def _segment(
    rng: np.random.Generator, kind: str, rows: int, limits: Array, pace: float, half: Array
) -> Array:
    """A path (rows, n) about zero, within its reach and the joints' speeds."""
    speed = np.minimum(0.7 * limits, 1.6) * pace
    make = {"sines": _sines, "reversals": _reversals}.get(kind, _moves)
    path = make(rng, rows, 1.6 * speed if kind == "fast_moves" else speed, half)
    reach = np.max(np.abs(path), axis=0)
    fastest = np.max(np.abs(np.diff(path, axis=0)), axis=0) / STEP
    share = np.minimum(half / np.maximum(reach, 1e-9), 0.85 * limits / np.maximum(fastest, 1e-9))
    return path * np.minimum(1.0, share)


def _sines(rng: np.random.Generator, rows: int, speed: Array, half: Array) -> Array:
    """Five sines per joint that fade in and out."""
    time = STEP * np.arange(rows)
    path = np.zeros((rows, len(half)))
    for joint in range(len(half)):
        rates = 2.0 * np.pi * np.exp(rng.uniform(np.log(0.07), np.log(0.7), 5))
        phases, weights = rng.uniform(0.0, 2.0 * np.pi, 5), rng.uniform(0.3, 1.0, 5)
        waves = (weights / rates) * np.sin(np.outer(time, rates) + phases)
        path[:, joint] = waves.sum(axis=1)
        path[:, joint] *= speed[joint] / np.max(np.abs(np.gradient(path[:, joint], STEP)))
    return path * smoothstep(np.minimum(time, time[-1] - time) / 1.5)[:, None]


def _moves(rng: np.random.Generator, rows: int, speed: Array, half: Array) -> Array:
    """Trapezoids of speed from pose to pose, all joints together or some, and rests, (T, n)."""
    path = np.zeros((rows, len(half)))
    row, here = 0, np.zeros(len(half))
    while row < rows:
        goal = rng.uniform(-1.0, 1.0, len(half)) * half
        if rng.random() < 0.35:
            goal = np.where(rng.random(len(half)) < 0.5, goal, here)
        time = max(0.5, float(np.max(1.25 * np.abs(goal - here) / speed)))
        rest = rng.uniform(0.1, 0.9)
        count = round(time / STEP)
        if row + count + 300 > rows:
            goal, count = np.zeros(len(half)), max(rows - row - 100, 1)
            if np.max(np.abs(here) / speed) * 1.25 > count * STEP:
                goal = here  # no time left to go home; the next segment's start is smoothed
        s = _trapezoid(count)
        end = min(row + count, rows)
        path[row:end] = here + s[: end - row, None] * (goal - here)
        here, row = goal, end
        end = min(row + round(rest / STEP), rows)
        path[row:end] = here
        row = end
    return path * _landing(rows)[:, None]


def _landing(rows: int) -> Array:
    """One, and down to zero over the last 1.6 s, so that segments meet at the middle."""
    return smoothstep(np.arange(rows)[::-1] * STEP / 1.6)


def _trapezoid(count: int) -> Array:
    """Path from 0 to 1 with speed rising over a fifth, holding, falling over a fifth, (count,)."""
    t = np.linspace(0.0, 1.0, count)
    speed = np.clip(np.minimum(t, 1.0 - t) / 0.2, 0.0, 1.0)
    path = np.cumsum(speed)
    return path / max(path[-1], 1e-12)


def _reversals(rng: np.random.Generator, rows: int, speed: Array, half: Array) -> Array:
    """Each joint slowly to and fro with corners rounded."""
    path = np.zeros((rows, len(half)))
    for joint in range(len(half)):
        pace = speed[joint] * rng.uniform(0.06, 0.3)
        reach = half[joint] * rng.uniform(0.15, 0.7)
        path[:, joint] = _triangle(rows, pace, reach, rng.uniform(0.0, 1.0))
    return path * _landing(rows)[:, None] * _landing(rows)[::-1, None]


def _triangle(rows: int, pace: float, reach: float, phase: float) -> Array:
    period = 4.0 * reach / pace
    turns = STEP * np.arange(rows) / period + phase
    return reach * (4.0 * np.abs((turns % 1.0) - 0.5) - 1.0)


def smoothstep(t: Array) -> Array:
    """Path from 0 to 1, at rest and without acceleration at both ends; constant beyond."""
    s = np.clip(t, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def smoothed(q: Array, width: float = 0.2) -> Array:
    """Rounded by a Hann window twice, so that accelerations are continuous."""
    count = max(3, round(width / STEP))
    window = np.hanning(count + 2)[1:-1]
    window /= window.sum()
    padded = np.pad(q, ((count, count), (0, 0)), mode="edge")
    for _ in range(2):
        padded = np.apply_along_axis(np.convolve, 0, padded, window, mode="same")
    return padded[count:-count]
