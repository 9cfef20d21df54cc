"""Wrap a solid in capsules: a first set by greedy cover, then moved until little sticks out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .hulls import FloatArray
from .segments import Capsules, to_segments
from .solid import Solid

_SEEDS_INSIDE, _SEEDS_ON = 110, 40  # ends of the segments that the greedy cover chooses from
_CHUNK = 2000  # candidates at a time
_STATIONS = 9  # along a segment, where its depth is asked


def farthest_points(points: FloatArray, count: int) -> NDArray[np.intp]:
    """Indices of points chosen one by one, each farthest from those before it."""
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    gap = np.linalg.norm(points - points[chosen[0]], axis=1)
    while len(chosen) < min(count, len(points)):
        chosen.append(int(gap.argmax()))
        gap = np.minimum(gap, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def candidates(solid: Solid, points: FloatArray, swell: float) -> Capsules:
    """Segments between seeds; radii such that nothing sticks out farther than `swell` [m].

    A ball of the radius of its center's depth is inside, so a capsule sticks out by no more than
    its radius less the least depth along its segment.
    """
    inner, _ = solid.inner_points()
    ends = points[farthest_points(points, _SEEDS_ON)]
    if len(inner):
        ends = np.concatenate([inner[farthest_points(inner, _SEEDS_INSIDE)], ends])
    i, j = np.triu_indices(len(ends))
    a, b = ends[i], ends[j]
    shares = np.linspace(0, 1, _STATIONS)
    stations = a[:, None] + shares[:, None] * (b - a)[:, None]
    depth = solid.depth_at(stations.reshape(-1, 3)).reshape(len(a), -1).min(axis=1)
    keep = depth > -0.5 * swell
    return Capsules(a[keep], b[keep], depth[keep] + swell)


def greedy_cover(solid: Solid, points: FloatArray, swell: float, share: float = 0.995) -> Capsules:
    """Candidates that each in turn hold most of what is left of points (P, 3), up to a share."""
    pool = candidates(solid, points, swell)
    count = len(pool.radius)
    parts = [pool.take(np.arange(n, min(n + _CHUNK, count))) for n in range(0, count, _CHUNK)]
    held = [to_segments(points, part.a, part.b) < part.radius for part in parts]
    holds = np.concatenate(held, axis=1) if held else np.empty((len(points), 0), dtype=bool)
    gain = holds.sum(axis=0)  # points that each would hold and none does yet
    left = np.ones(len(points), dtype=bool)
    chosen: list[int] = []
    while left.sum() > (1 - share) * len(points):
        best = int(gain.argmax())
        if gain[best] <= 0:
            break
        chosen.append(best)
        newly = left & holds[:, best]
        gain -= holds[newly].sum(axis=0)
        left &= ~newly
    return pool.take(chosen)


class ShrinkWrap:
    """Moves capsules so that they hold points and what sticks out is least: `_core.ShrinkWrap`."""

    def __init__(self, solid: Solid, points: FloatArray, worst: float) -> None:
        self._wrap = _core.ShrinkWrap(
            depth=solid.depth, origin=solid.origin, edge=solid.edge, points=points, worst=worst
        )

    def move(self, capsules: Capsules, steps: int) -> Capsules:
        """What comes back leaves points outside by some tenths of a millimetre."""
        rows = np.column_stack(capsules)
        moved = self._wrap.move(rows, steps)
        return Capsules(moved[:, :3], moved[:, 3:6], moved[:, 6])
