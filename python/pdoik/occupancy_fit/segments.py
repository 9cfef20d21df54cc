"""Sets of capsules as arrays: distances to their segments, and points on their surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .hulls import FloatArray

_GOLDEN_TURN = np.pi * (3 - np.sqrt(5))


class Capsules(NamedTuple):
    """K balls swept along segments; a segment of no length leaves a ball."""

    a: FloatArray  # (K, 3) [m]
    b: FloatArray  # (K, 3) [m]
    radius: FloatArray  # (K,) [m]

    def take(self, index: FloatArray | list[int]) -> Capsules:
        """The capsules that an index or a mask chooses."""
        return Capsules(self.a[index], self.b[index], self.radius[index])


def nearest_on_segments(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Where on segment k, 0 at a and 1 at b, the nearest place to point p is, (P, K)."""
    along = b - a
    length2 = np.maximum(np.einsum("ki,ki->k", along, along), 1e-18)
    at = points @ along.T - np.einsum("ki,ki->k", a, along)
    return np.asarray(np.clip(at / length2, 0, 1))


def to_segments(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Distance of each point (P, 3) to each segment, (P, K) [m]."""
    t = nearest_on_segments(points, a, b)
    squares = np.zeros_like(t)
    for i in range(3):  # three passes over (P, K) are faster than one over (P, K, 3)
        offset = points[:, i, None] - (a[:, i] + t * (b - a)[:, i])
        squares += offset * offset
    return np.sqrt(squares)


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


def free(capsules: Capsules, on: Surface) -> np.ndarray:
    """Which of the surface points are in no other capsule, (K, N)."""
    shape = on.points.shape[:2]
    gap = to_segments(on.points.reshape(-1, 3), capsules.a, capsules.b) - capsules.radius
    gap = gap.reshape(*shape, -1)
    own = np.arange(shape[0])
    gap[own, :, own] = np.inf
    return np.asarray((gap > 0).all(axis=2))
