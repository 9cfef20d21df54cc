"""Sets of capsules as arrays: distances to their segments, and points on their surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .hulls import FloatArray

_BLOCK = 20_000  # distances at a time: as much as stays in a processor's cache
_GOLDEN_TURN = np.pi * (3 - np.sqrt(5))


class Capsules(NamedTuple):
    """K balls swept along segments; a segment of no length leaves a ball."""

    a: FloatArray  # (K, 3) [m]
    b: FloatArray  # (K, 3) [m]
    radius: FloatArray  # (K,) [m]

    def take(self, index: NDArray[np.intp] | NDArray[np.bool_] | list[int]) -> Capsules:
        """The capsules that an index or a mask chooses."""
        return Capsules(self.a[index], self.b[index], self.radius[index])


def to_segments(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Distance of each point (P, 3) to each segment, (P, K) [m].

    To 1e-8 m or better where points and segments are within metres of each other.
    """
    center = points.mean(axis=0) if len(points) else np.zeros(3)
    a, along = a - center, b - a
    length2 = np.einsum("ki,ki->k", along, along)
    share = 1 / np.maximum(length2, 1e-18)
    from_a, a2 = np.einsum("ki,ki->k", a, along), np.einsum("ki,ki->k", a, a)
    distance = np.empty((len(points), len(a)))
    step = max(_BLOCK // max(len(a), 1), 1)
    for n in range(0, len(points), step):
        p = points[n : n + step] - center
        s = p @ along.T - from_a  # (p - a) . (b - a)
        t = np.minimum(np.maximum(s * share, 0), 1)
        square = np.einsum("pi,pi->p", p, p)[:, None] - 2 * (p @ a.T) + a2
        square -= t * (2 * s - t * length2)
        np.sqrt(np.maximum(square, 0), out=distance[n : n + step])
    return distance


class Surface(NamedTuple):
    """N points spread evenly over the surface of each of K capsules."""

    points: FloatArray  # (K, N, 3) [m]
    normals: FloatArray  # (K, N, 3), outwards
    at: FloatArray  # (K, N), the place on the segment, 0 at a and 1 at b, that each moves with
    areas: FloatArray  # (K,), of a capsule's surface over N [m^2]


def surface(capsules: Capsules, count: int, turn: float = 0.0) -> Surface:
    """Points all over each capsule, by a spiral around its axis, (K, count).

    By Archimedes' theorem equal heights along the axis, caps included, are equal areas.

    Args:
        capsules: K of them.
        count: Points on each.
        turn: Shifts the spiral, in [0, 1): other points of the same density.
    """
    a, b, radius = capsules
    length = np.linalg.norm(b - a, axis=1)
    axis = np.where(length[:, None] > 1e-9, b - a, [0.0, 0.0, 1.0])
    axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    least = np.eye(3)[np.abs(axis).argmin(axis=1)]
    across = np.cross(axis, least)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    third = np.cross(axis, across)
    height = (np.arange(count) + (0.5 + turn) % 1) / count
    z = height * (length + 2 * radius)[:, None] - radius[:, None]  # (K, N), 0 at a
    on_axis = np.clip(z, 0, length[:, None])
    sine = (z - on_axis) / radius[:, None]
    cosine = np.sqrt(np.maximum(1 - sine**2, 0))
    angle = _GOLDEN_TURN * np.arange(count) + 2 * np.pi * turn
    normals = sine[:, :, None] * axis[:, None] + cosine[:, :, None] * (
        np.cos(angle)[:, None] * across[:, None] + np.sin(angle)[:, None] * third[:, None]
    )
    foot = a[:, None] + on_axis[:, :, None] * axis[:, None]
    return Surface(
        points=foot + radius[:, None, None] * normals,
        normals=normals,
        at=on_axis / np.maximum(length, 1e-9)[:, None],
        areas=2 * np.pi * radius * (length + 2 * radius) / count,
    )


def free(capsules: Capsules, on: Surface) -> NDArray[np.bool_]:
    """Which of the surface points are in no other capsule, (K, N)."""
    shape = on.points.shape[:2]
    gap = to_segments(on.points.reshape(-1, 3), capsules.a, capsules.b) - capsules.radius
    gap = gap.reshape(*shape, -1)
    own = np.arange(shape[0])
    gap[own, :, own] = np.inf
    return np.asarray((gap > 0).all(axis=2))
