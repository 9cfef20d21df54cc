"""Which recording is best held out: one whose motion the others cover, but do not repeat."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray, Recording

_MOVES = 0.05  # numerics: range from which a motion is one [rad]
_CELLS = 12  # of each joint's positions, and of its speeds
_LEAST_COVERED = 0.6  # numerics: of two recordings, below which the one says little of the other
_SAME = 0.1  # numerics: of the motion's size: by how little a repetition differs
_RATE = 20.0  # at which motions are compared [Hz]


@dataclass(frozen=True, slots=True, kw_only=True)
class HoldOut:
    """A recording to be held out, by name; "" for none."""

    name: str
    why: str


def hold_out(recordings: Mapping[str, tuple[Recording, ...]]) -> HoldOut:
    """Choose the recording to hold out, by files' names; each is in one part or more.

    Coverage is the share of a recording's samples that lie, joint by joint, in a cell of position
    and speed where another recording has been, or next to one.
    """
    if len(recordings) < 2:
        return HoldOut(name="", why="there is one recording: its last part is held out")
    motions = {name: _motion(parts) for name, parts in recordings.items()}
    covered = {
        name: _covered(motion, [m for other, m in motions.items() if other != name])
        for name, motion in motions.items()
    }
    repeats = {
        name: any(_repeats(motion, m) for other, m in motions.items() if other != name)
        for name, motion in motions.items()
    }
    moving = [name for name, (q, _) in motions.items() if np.ptp(q, axis=0).max() > _MOVES]
    own = [name for name in moving if not repeats[name]] or moving or [*motions]
    best = max(own, key=lambda name: covered[name])
    if len(recordings) == 2 and covered[best] < _LEAST_COVERED:
        return HoldOut(
            name="",
            why=f"of two recordings neither covers the other's motion ({100 * covered[best]:.0f} %"
            " at most): the last part of each is held out",
        )
    again = "" if best in own and not repeats[best] else ", though it repeats one of them"
    return HoldOut(
        name=best,
        why=f"{100 * covered[best]:.0f} % of its motion is where the others have been{again}",
    )


def _motion(parts: tuple[Recording, ...]) -> tuple[FloatArray, FloatArray]:
    """Positions and speeds at a low rate, (T, n) each."""
    q, dq = [], []
    for each in parts:
        every = max(1, round(1.0 / (_RATE * each.period)))
        rows = each.q[::every]
        if len(rows) > 1:
            q.append(rows)
            dq.append(np.gradient(rows, every * each.period, axis=0))
    return np.concatenate(q), np.concatenate(dq)


def _covered(
    motion: tuple[FloatArray, FloatArray], others: list[tuple[FloatArray, FloatArray]]
) -> float:
    shares = []
    for j in range(motion[0].shape[1]):
        q, dq = motion[0][:, j], motion[1][:, j]
        others_q = np.concatenate([m[0][:, j] for m in others])
        others_dq = np.concatenate([m[1][:, j] for m in others])
        edges = [np.linspace(*_range(q, others_q), _CELLS + 1)]
        edges.append(np.linspace(*_range(dq, others_dq), _CELLS + 1))
        visited = np.histogram2d(others_q, others_dq, edges)[0] > 0
        padded = np.pad(visited, 1)
        near = np.zeros_like(visited)
        for a in range(3):
            for b in range(3):
                near |= padded[a : a + _CELLS, b : b + _CELLS]
        count = np.histogram2d(q, dq, edges)[0]
        shares.append(float(count[near].sum() / max(count.sum(), 1.0)))
    return float(np.mean(shares))


def _range(a: FloatArray, b: FloatArray) -> tuple[float, float]:
    low, high = min(a.min(), b.min()), max(a.max(), b.max())
    return float(low) - 1e-6, float(high) + 1e-6


def _repeats(one: tuple[FloatArray, FloatArray], other: tuple[FloatArray, FloatArray]) -> bool:
    """Whether positions are nearly the same all along."""
    count = min(len(one[0]), len(other[0]))
    a, b = one[0][:count], other[0][:count]
    size = float(np.sqrt(np.mean((a - a.mean(axis=0)) ** 2)))
    return float(np.sqrt(np.mean((a - b) ** 2))) < _SAME * max(size, 1e-9)
