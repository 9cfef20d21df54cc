"""Small spheroids about many sets of points at once, roughly: what cuts are ranked by."""

from __future__ import annotations

import numpy as np

from .hulls import MARGIN, FloatArray, Shape, half_sum

_DIRECTIONS = 64  # in which the farthest points of a set stand for it
_STEPS = 60
_FIRST_STEP, _LAST_STEP = 0.08, 0.002  # of the sets' size
_FIRST_BLUR, _LAST_BLUR = 0.05, 0.002  # of the largest half sum, of the sets' size
_START = 0.7  # of a set's extent, how far the foci are apart at first


class Halves:
    """The two sides of any plane through a surface, by their farthest points in fixed directions.

    A side's farthest points are vertices of the surface or lie where the plane crosses its edges.
    """

    def __init__(self, triangles: FloatArray) -> None:
        """The halves of triangles (T, 3, 3) [m]."""
        self._vertices, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        faces = index.reshape(-1, 3)
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]))
        self._edges = np.unique(edges, axis=0)
        self.directions = _spiral(_DIRECTIONS)
        self._reach = np.einsum("vi,di->vd", self._vertices, self.directions)

    def of(self, normal: FloatArray, offset: float) -> FloatArray | None:
        """The sides normal . x >= offset and <= offset, (2, M, 3); None if the plane cuts nothing.

        A plane through a vertex or along a face leaves that much on its other side: no cut either.
        """
        height = np.einsum("vi,i->v", self._vertices, normal) - offset
        ends = height[self._edges]
        crossed = self._edges[ends[:, 0] * ends[:, 1] < 0]
        if not len(crossed):
            return None
        p, q = self._vertices[crossed[:, 0]], self._vertices[crossed[:, 1]]
        share = height[crossed[:, 0]] / (height[crossed[:, 0]] - height[crossed[:, 1]])
        points = np.concatenate([self._vertices, p + share[:, None] * (q - p)])
        beyond = np.einsum("vi,di->vd", points[len(height) :], self.directions)
        reach = np.concatenate([self._reach, beyond])
        on_plane = np.ones(len(crossed), dtype=bool)
        sides = []
        for side in (height >= 0, height <= 0):
            there = np.concatenate([side, on_plane])[:, None]
            sides.append(points[np.where(there, reach, -np.inf).argmax(axis=0)])
        return np.stack(sides)


def rough_shapes(sets: FloatArray) -> list[Shape]:
    """A spheroid of nearly least volume about each of B sets of points (B, M, 3).

    By Adam on log a + log(a^2 - |half|^2), where the foci are centre -+ half, from two starts.
    The largest half sum a is blurred at first, so that many points pull.
    """
    low, high = sets.min(axis=1), sets.max(axis=1)
    origin = (low + high) / 2
    scale = np.maximum((high - low).max(axis=1) / 2, MARGIN)
    unit = (sets - origin[:, None]) / scale[:, None, None]
    centered = unit - unit.mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(np.einsum("bmi,bmj->bij", centered, centered))
    best, center, half = np.full(len(sets), np.inf), np.zeros_like(origin), np.zeros_like(origin)
    for k in (2, 1):  # the longest axis, the next
        extent = np.abs(np.einsum("bmi,bi->bm", unit, axes[:, :, k])).max(axis=1)
        value, x = _descended(unit, _START * extent[:, None] * axes[:, :, k])
        better = value < best
        best = np.where(better, value, best)
        center[better], half[better] = x[better, :3], x[better, 3:]
    center, half = origin + scale[:, None] * center, scale[:, None] * half
    a, b = center - half, center + half
    semi_major = half_sum(sets, a[:, None], b[:, None]).max(axis=1) + MARGIN
    return [Shape(*shape) for shape in zip(a, b, semi_major.tolist(), strict=True)]


def _descended(points: FloatArray, half: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The least log volume met, (B,), and its (centre, half), (B, 6)."""
    x = np.concatenate([np.zeros_like(half), half], axis=1)
    first, second = np.zeros_like(x), np.zeros_like(x)
    least, at = np.full(len(x), np.inf), x
    shares = np.linspace(0, 1, _STEPS)
    for n, share in enumerate(shares, start=1):
        value, gradient = _log_volume(points, x, _FIRST_BLUR * (_LAST_BLUR / _FIRST_BLUR) ** share)
        better = value < least
        least, at = np.where(better, value, least), np.where(better[:, None], x, at)
        first = 0.7 * first + 0.3 * gradient
        second = 0.9 * second + 0.1 * (gradient**2).sum(axis=1, keepdims=True)
        size = np.sqrt(second / (1 - 0.9**n)) + 1e-12
        step = _FIRST_STEP * (_LAST_STEP / _FIRST_STEP) ** share
        x = x - step * first / (1 - 0.7**n) / size
    return least, at


def _log_volume(points: FloatArray, x: FloatArray, blur: float) -> tuple[FloatArray, FloatArray]:
    """The log of the volume over 4/3 pi, (B,), and its derivative by x, the maximum blurred."""
    center, half = x[:, None, :3], x[:, None, 3:]
    to_a, to_b = points - center + half, points - center - half
    from_a = np.sqrt(np.einsum("bmi,bmi->bm", to_a, to_a)) + 1e-12
    from_b = np.sqrt(np.einsum("bmi,bmi->bm", to_b, to_b)) + 1e-12
    sums = (from_a + from_b) / 2
    a = sums.max(axis=1)
    weight = np.exp((sums - a[:, None]) / blur)
    weight /= 2 * weight.sum(axis=1, keepdims=True)
    by_a = np.einsum("bm,bmi->bi", weight / from_a, to_a)
    by_b = np.einsum("bm,bmi->bi", weight / from_b, to_b)
    b2 = np.maximum(a * a - (x[:, 3:] ** 2).sum(axis=1), 1e-9)
    by_sum = (1 / a + 2 * a / b2)[:, None]
    gradient = [-by_sum * (by_a + by_b), by_sum * (by_a - by_b) - 2 * x[:, 3:] / b2[:, None]]
    return np.log(a) + np.log(b2), np.concatenate(gradient, axis=1)


def _spiral(count: int) -> FloatArray:
    """Directions spread evenly, (count, 3)."""
    z = 1 - (2 * np.arange(count) + 1) / count
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
