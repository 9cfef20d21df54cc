"""Where the tool is slower than asked for, and what keeps it from being faster."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pdoik.timing.limits import Tool
from pdoik.timing.piece import Use
from pdoik.timing.trajectory import Dip, Limit

FloatArray = npt.NDArray[np.float64]

_LIMITS: tuple[Limit, ...] = ("speed", "acceleration", "jerk", "turn")
_SLOW, _FAST = 0.99, 0.995  # of tool_speed: a dip falls below one and ends above the other
_BINDS = 0.999  # of a limit, from which on it keeps the tool slow
_FALLS = 1e-3  # of tool_speed, by which the tool is slower than before
_USED = 0.5  # of a limit, at least, by the one that keeps the tool slow
_LOWEST = 1.02  # times a dip's lowest speed: where it is asked what binds


def dips(use: Use, tool: Tool, start: float, names: Sequence[str]) -> list[Dip]:
    """Dips of a motion from rest to rest that starts at a time, in order."""
    share = use.ratios["tool"][:, 0]
    other = np.hstack([use.ratios["speed"], use.ratios["turn"]]).max(axis=1)
    first, last = _ramp(share, other), len(share) - 1 - _ramp(share[::-1], other[::-1])
    found = []
    for a, b in _stretches(share[first : last + 1] < _FAST):
        k = np.arange(first + a, first + b)
        lowest = share[k].min()
        if lowest >= _SLOW:
            continue
        limit, joint = _binding(use, k[share[k] <= _LOWEST * lowest + 1e-12])
        found.append(
            Dip(
                start=start + float(use.time[k[0]]),
                end=start + float(use.time[k[-1]]),
                start_at=float(use.at[k[0]]),
                end_at=float(use.at[k[-1]]),
                speed=float(lowest * tool.speed),
                limit=limit,
                joint="" if joint is None else names[joint],
            )
        )
    return found


def _ramp(share: FloatArray, other: FloatArray) -> int:
    """Where speeding up from rest ends: at full speed, at a limit of speed, or by slowing down."""
    best = np.maximum.accumulate(share)
    ends = (share >= _SLOW) | (other >= _BINDS) | (share < best - _FALLS)
    end = int(np.argmax(ends)) if ends.any() else len(share) - 1
    return int(np.argmax(share[: end + 1]))


def _stretches(inside: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and past the last of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _binding(use: Use, k: npt.NDArray[np.int64]) -> tuple[Limit, int | None]:
    """The limit that is used most there, and whose it is."""
    means = {name: use.ratios[name][k].mean(axis=0) for name in _LIMITS}
    limit = max(_LIMITS, key=lambda name: float(means[name].max()))
    if means[limit].max() < _USED:
        return "resolution", None
    return limit, None if limit == "turn" else int(means[limit].argmax())
