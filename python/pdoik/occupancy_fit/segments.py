"""Sets of capsules as arrays: distances to their segments, and points on their surfaces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .hulls import FloatArray

AnyFloats = NDArray[np.floating[Any]]

_BLOCK = 20_000  # distances at a time: as much as stays in a processor's cache
_GOLDEN_TURN = np.pi * (3 - np.sqrt(5))


class Capsules(NamedTuple):
    """K balls swept along segments; a segment of no length leaves a ball."""

    a: FloatArray  # (K, 3) [m]
    b: FloatArray  # (K, 3) [m]
    radius: FloatArray  # (K,) [m]

    def take(self, index: NDArray[np.intp] | NDArray[np.bool_] | slice | list[int]) -> Capsules:
        """The capsules that an index or a mask chooses."""
        return Capsules(self.a[index], self.b[index], self.radius[index])


def to_segments(points: AnyFloats, a: FloatArray, b: FloatArray) -> AnyFloats:
    """Distance of each point (P, 3) to each segment, (P, K) [m].

    To 1e-8 m or better where points and segments are within metres of each other. Points in single
    precision give distances in it, in half the time: to 1e-5 m beyond 1 mm from a segment.
    """
    kind = points.dtype
    center = points.mean(axis=0, dtype=np.float64) if len(points) else np.zeros(3)
    a, along = a - center, b - a
    length = np.linalg.norm(along, axis=1)
    axis = along / np.maximum(length, 1e-12)[:, None]
    zero, one = np.zeros((len(a), 1)), np.ones((len(a), 1))
    a2 = np.einsum("ki,ki->k", a, a)[:, None]
    from_a = np.einsum("ki,ki->k", a, axis)[:, None]
    # A point's place along the axis, and its squared distance from a, as products with (p, p^2, 1).
    to_place = np.concatenate([axis, zero, -from_a], axis=1).T.astype(kind)
    to_square = np.concatenate([-2 * a, one, a2], axis=1).T.astype(kind)
    length = length.astype(kind)
    distance = np.empty((len(points), len(a)), dtype=kind)
    step = max(_BLOCK // max(len(a), 1), 1)
    for n in range(0, len(points), step):
        p = points[n : n + step] - center
        p2 = np.einsum("pi,pi->p", p, p)[:, None]
        p = np.concatenate([p, p2, np.ones_like(p2)], axis=1).astype(kind)
        place, square = p @ to_place, distance[n : n + step]
        on_segment = np.minimum(np.maximum(place, 0), length)
        np.matmul(p, to_square, out=square)
        place += place  # |p - a|^2 - s^2 + (s - t)^2 with s = place, t = on_segment
        place -= on_segment
        place *= on_segment
        square -= place
        np.sqrt(np.maximum(square, 0, out=square), out=square)
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
    length = np.sqrt(np.einsum("ki,ki->k", b - a, b - a))
    height = (np.arange(count) + (0.5 + turn) % 1) / count
    z = height * (length + 2 * radius)[:, None] - radius[:, None]  # (K, N), 0 at a
    on_axis = np.minimum(np.maximum(z, 0), length[:, None])
    sine = (z - on_axis) / radius[:, None]
    cosine = np.sqrt(np.maximum(1 - sine**2, 0))
    angle = _GOLDEN_TURN * np.arange(count) + 2 * np.pi * turn
    local = np.stack([sine, cosine * np.cos(angle), cosine * np.sin(angle)], axis=2)
    triads = _triads(b - a, length)
    normals = local @ triads
    local *= radius[:, None, None]
    local[:, :, 0] += on_axis
    return Surface(
        points=local @ triads + a[:, None],
        normals=normals,
        at=on_axis / np.maximum(length, 1e-9)[:, None],
        areas=2 * np.pi * radius * (length + 2 * radius) / count,
    )


def _triads(along: FloatArray, length: FloatArray) -> FloatArray:
    """Right-handed triads of unit vectors, the first along each of K vectors, as rows (K, 3, 3)."""
    axis = np.where(length[:, None] > 1e-9, along, [0.0, 0.0, 1.0])
    axis /= np.sqrt(np.einsum("ki,ki->k", axis, axis))[:, None]
    each, least = np.arange(len(axis)), np.abs(axis).argmin(axis=1)
    across = np.zeros_like(axis)  # the product with the axis of the frame that is least along
    across[each, (least + 1) % 3] = axis[each, (least + 2) % 3]
    across[each, (least + 2) % 3] = -axis[each, (least + 1) % 3]
    across /= np.sqrt(np.einsum("ki,ki->k", across, across))[:, None]
    (x, y, z), (u, v, w) = axis.T, across.T
    third = np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=1)
    return np.stack([axis, across, third], axis=1)


def free(
    capsules: Capsules, on: Surface, among: NDArray[np.bool_] | None = None
) -> NDArray[np.bool_]:
    """Which of the surface points, or of those `among` them, are in no other capsule, (K, N).

    In single precision, good to 1e-5 m.
    """
    among = np.ones(on.at.shape, dtype=bool) if among is None else among
    own = np.nonzero(among)[0]
    points = on.points[among].astype(np.float32)
    gap = to_segments(points, capsules.a, capsules.b) - capsules.radius.astype(np.float32)
    gap[np.arange(len(own)), own] = np.inf
    outer = np.zeros(on.at.shape, dtype=bool)
    outer[among] = (gap > 0).all(axis=1)
    return outer
