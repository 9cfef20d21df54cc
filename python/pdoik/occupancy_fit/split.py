"""Cover a link by a few small hulls: cut its surface by planes and wrap each part."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from .hulls import FloatArray, Shape, convex_volume, principal_axes, smallest_shape
from .rough import Halves, rough_shapes

_OFFSETS = (0.2, 0.35, 0.5, 0.65, 0.8)  # where along its normal a part is first cut
_FINALISTS = 2  # planes that are moved further
_NEAR, _REACHES = 16, (0.25, 0.12, 0.06)  # planes near one, and how near round by round
_COARSE_SAMPLES, _FINE_SAMPLES = 4_000, 60_000
_NONE = np.empty((0, 2, 3))
_MIN_GAIN = 0.04  # of a link's covered volume, below which one more hull is not worth its time


class Part(NamedTuple):
    """A piece of a link's surface and the hull that holds it."""

    triangles: FloatArray  # (T, 3, 3) [m]
    shape: Shape

    @property
    def points(self) -> FloatArray:
        return self.triangles.reshape(-1, 3)


def clip(triangles: FloatArray, normal: FloatArray, offset: float) -> FloatArray:
    """What of the triangles (T, 3, 3) lies in the half-space normal . x >= offset.

    A triangle the plane crosses is cut: the crossing points of its edges become corners, so the
    parts on both sides together are the whole surface. Triangles in the plane fall on both sides.
    """
    height = np.einsum("tci,i->tc", triangles, normal) - offset  # (T, 3), see principal_axes
    inside = height >= 0
    count = inside.sum(axis=1)
    pieces = [triangles[count == 3]]
    for n_inside in (1, 2):
        chosen = count == n_inside
        lone = np.argmax(inside[chosen] == (n_inside == 1), axis=1)  # the corner on its own side
        order = (lone[:, None] + np.arange(3)) % 3
        t = np.take_along_axis(triangles[chosen], order[:, :, None], axis=1)
        h = np.take_along_axis(height[chosen], order, axis=1)
        p, q, r = t[:, 0], t[:, 1], t[:, 2]
        pq = p + (q - p) * (h[:, 0] / (h[:, 0] - h[:, 1]))[:, None]
        pr = p + (r - p) * (h[:, 0] / (h[:, 0] - h[:, 2]))[:, None]
        if n_inside == 1:
            pieces.append(np.stack([p, pq, pr], axis=1))
        else:
            pieces += [np.stack([pq, q, r], axis=1), np.stack([pq, r, pr], axis=1)]
    return np.concatenate(pieces)


def union_volume(shapes: list[Shape], samples: int = _FINE_SAMPLES) -> float:
    """Volume of the shapes' union [m^3], by a Halton sequence: the same input, the same result."""
    if len(shapes) == 1:
        return shapes[0].volume
    lower = np.min([(s.focus_a + s.focus_b) / 2 - s.semi_major for s in shapes], axis=0)
    upper = np.max([(s.focus_a + s.focus_b) / 2 + s.semi_major for s in shapes], axis=0)
    points = lower + _halton(samples) * (upper - lower)
    covered = np.any([shape.contains(points) for shape in shapes], axis=0)
    return float(np.prod(upper - lower) * covered.mean())


_HALTON: dict[int, FloatArray] = {}


def _halton(samples: int) -> FloatArray:
    if samples not in _HALTON:
        _HALTON[samples] = np.asarray(qmc.Halton(d=3, scramble=False).random(samples))
    return _HALTON[samples]


def cover_stages(
    triangles: FloatArray, max_volume_factor: float, max_parts: int
) -> list[list[Part]]:
    """Covers of the surface, and of whatever solid it bounds, by 1, 2, ... parts' hulls.

    The solid's share of a half-space is spanned by the clipped surface, so convex hulls around
    the parts lose nothing of it. One part is split at a time, the one whose cut gains most, until
    the hulls' union is within the factor of the surface's convex hull or there are `max_parts`.
    A stage is kept when each hull more than the last kept one gains enough.
    """
    limit = max_volume_factor * convex_volume(triangles.reshape(-1, 3))
    parts = [Part(triangles, smallest_shape(triangles.reshape(-1, 3)))]
    volume = parts[0].shape.volume
    kept, kept_volume = [parts], volume
    cuts: list[list[Part] | None] = [None]  # of each part; found when first asked for, then kept
    while volume > limit and len(parts) < max_parts:
        cuts = [_split(part) if cut is None else cut for part, cut in zip(parts, cuts, strict=True)]
        options = {i: parts[:i] + cut + parts[i + 1 :] for i, cut in enumerate(cuts) if cut}
        if not options:
            break
        volumes = {i: union_volume([p.shape for p in option]) for i, option in options.items()}
        best = min(volumes, key=lambda index: volumes[index])
        parts, volume = options[best], volumes[best]
        cuts[best : best + 1] = [None, None]
        if volume < (1 - _MIN_GAIN) ** (len(parts) - len(kept[-1])) * kept_volume:
            kept.append(parts)
            kept_volume = volume
    return kept


def _split(part: Part) -> list[Part]:
    """Two parts, cut by the plane that leaves the smallest union of their hulls, or none.

    Planes are ranked by rough hulls; only the best one's halves are wrapped in the smallest.
    """
    points = part.points
    diagonals = [np.roll([1.0, sign, 0.0], k) / np.sqrt(2) for k in range(3) for sign in (1, -1)]
    planes = []
    for normal in [*np.eye(3), *diagonals, *principal_axes(points)]:
        heights = np.einsum("ni,i->n", points, normal)
        low, high = heights.min(), heights.max()
        planes += [np.append(normal, low + share * (high - low)) for share in _OFFSETS]
    volumes = _cut_volumes(Halves(part.triangles), np.array(planes))
    best = np.argsort(volumes)[:_FINALISTS]
    finalists = [planes[index] for index in best if np.isfinite(volumes[index])]
    finalists += [_refine(part, plane) for plane in finalists]
    if not finalists:
        return []
    volumes = _cut_volumes(Halves(part.triangles), np.array(finalists))
    halves = _halves(part, finalists[int(np.argmin(volumes))])
    if not all(len(half) for half in halves):
        return []
    return [Part(half, smallest_shape(half.reshape(-1, 3))) for half in halves]


def _halves(part: Part, plane: FloatArray) -> list[FloatArray]:
    normal = plane[:3] / np.linalg.norm(plane[:3])
    return [clip(part.triangles, normal, plane[3]), clip(part.triangles, -normal, -plane[3])]


def _cut_volumes(halves: Halves, planes: FloatArray) -> FloatArray:
    """Union of rough hulls on both sides of each plane (N, 4), (N,) [m^3]; inf if it cuts nothing.

    A plane through a vertex or along a face leaves that much on its other side: no cut either.
    """
    volumes = np.full(len(planes), np.inf)
    sides = [halves.of(plane[:3], plane[3]) for plane in planes]
    cuts = [index for index, both in enumerate(sides) if both is not None]
    shapes = rough_shapes(np.concatenate([both for both in sides if both is not None] or [_NONE]))
    for k, index in enumerate(cuts):
        volumes[index] = union_volume(shapes[2 * k : 2 * k + 2], _COARSE_SAMPLES)
    return volumes


def _refine(part: Part, plane: FloatArray) -> FloatArray:
    """Turn and shift the plane a little: the best of many near it, then of many nearer to that."""
    size = float(np.ptp(part.points, axis=0).max())
    tangents = np.linalg.svd(plane[None, :3])[2][1:]
    center = part.points.mean(axis=0)
    halves = Halves(part.triangles)

    def moved(x: FloatArray) -> FloatArray:
        normal = plane[:3] + x[:2] @ tangents
        shift = (plane[3] - plane[:3] @ center) + 0.3 * size * x[2]
        normal = normal / np.linalg.norm(normal)
        return np.append(normal, normal @ center + shift)

    around, best = 2 * _halton(_NEAR) - 1, np.zeros(3)
    for reach in _REACHES:
        near = np.concatenate([best[None], best + reach * around])
        best = near[int(np.argmin(_cut_volumes(halves, np.array([moved(x) for x in near]))))]
    return moved(best)
