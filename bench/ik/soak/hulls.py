"""Distances to hulls by their definition, in double precision, every hull with every point.

Besides hulls there are capsules, balls swept along segments; their ends and radii stand in the same
arrays as foci and A.
"""

import numpy as np

from bench.common.arrays import BoolArray, FloatArray
from bench.ik.judges.distances import hull_distance, to_segment

PAIRS = 200_000  # of a hull and a point that are looked at together: what a cache holds

_AT_ONCE = 5000  # points and capsules, of which distances are taken together: what a cache holds


def clearance(
    a: FloatArray,
    b: FloatArray,
    A: FloatArray,
    points: FloatArray,
    swept: BoolArray | None = None,
) -> FloatArray:
    """Least distance of any point, less its radius, to any hull, (B,), infinite without any [m].

    Hulls have foci a and b in each of B placements, (B, H, 3), and semi-major axes A, (H,); those
    that are `swept`, (H,), are capsules. Points are centres and radii, (N, 4), or of each placement
    its own, (B, N, 4).
    """
    if swept is not None and swept.any():
        wide = clearance(a[:, ~swept], b[:, ~swept], A[~swept], points)
        return np.minimum(wide, _to_capsules(a[:, swept], b[:, swept], A[swept], points))
    least = np.full(len(a), np.inf)
    hulls, count = len(A), points.shape[-2]
    if hulls == 0 or count == 0:
        return least
    rows = max(1, PAIRS // (hulls * count))
    for first in range(0, len(a), rows):
        some = slice(first, first + rows)
        own = points[some] if points.ndim == 3 else points
        least[some] = _least(a[some], b[some], A, own)
    return least


def _least(a: FloatArray, b: FloatArray, A: FloatArray, points: FloatArray) -> FloatArray:
    """See `clearance`; outside a hull s - A, with s the mean distance to the foci, is a bound.

    A point that moves changes s by no more than it moves, so s - A is never more than the distance;
    and the hull with semi-major axis s about the same foci, on whose surface the point lies, is
    nowhere farther from that with A than at the waist, where they are B(s) - B(A) apart. Inside a
    hull both hold with their signs turned round.
    """
    radii = points[..., None, :, 3]
    excess = _half_sums(a, b, points) - (A[:, None] + radii)  # (B, H, N)
    half = 0.5 * np.linalg.norm(b - a, axis=2)
    empty = np.linalg.norm(b - a, axis=2) >= 2.0 * A
    if empty.any():
        excess[empty] = np.inf
    scale = 1.0 + np.abs(points[..., :3]).max() + np.abs(a).max()
    slack = 1e-7 * scale  # of the rounding in `_half_sums`
    waist = np.sqrt(np.maximum((A - half) * (A + half), 0.0))
    at = excess.reshape(len(a), -1).argmin(axis=1)
    row = np.arange(len(a))
    hull, point = np.unravel_index(at, excess.shape[1:])
    radius = np.broadcast_to(radii, (len(a), 1, points.shape[-2]))[row, 0, point]
    s = excess[row, hull, point] + A[hull] + radius
    wide = np.sqrt(np.maximum((s - half[row, hull]) * (s + half[row, hull]), 0.0))
    upper = np.where(s > A[hull], wide - waist[row, hull], s - A[hull]) - radius + slack
    may_be_less = excess <= upper[:, None, None] + slack
    may_be_less |= excess + radii <= slack  # inside the distance may be far below the bound
    least = np.full(len(a), np.inf)
    row, hull, point = np.nonzero(may_be_less)
    own = points[row, point] if points.ndim == 3 else points[point]
    exact = hull_distance(own[:, :3], a[row, hull], b[row, hull], A[hull]) - own[:, 3]
    np.minimum.at(least, row, exact)
    return least


def _to_capsules(a: FloatArray, b: FloatArray, r: FloatArray, points: FloatArray) -> FloatArray:
    """See `clearance`, of capsules only."""
    least = np.full(len(a), np.inf)
    for n in range(len(a) if points.shape[-2] and len(r) else 0):
        own = points[n] if points.ndim == 3 else points
        at_once = max(1, _AT_ONCE // len(own))
        for k in range(0, len(r), at_once):
            some = slice(k, k + at_once)
            gap = to_segment(own[:, :3], a[n, some, None], b[n, some, None]) - own[:, 3]
            least[n] = min(least[n], float((gap - r[some, None]).min()))
    return least


def _half_sums(a: FloatArray, b: FloatArray, points: FloatArray) -> FloatArray:
    """Mean distances of points to the foci, (B, H, N), good to about 1e-8 of the coordinates."""
    centre = a.mean(axis=(0, 1))
    to = np.ascontiguousarray(np.swapaxes(points[..., :3] - centre, -1, -2))  # (3, N)
    squares = np.einsum("...in,...in->...n", to, to)[..., None, :]

    def distances(foci: FloatArray) -> FloatArray:
        at = foci - centre
        d = np.matmul(at, -2.0 * to)
        d += squares
        d += np.einsum("bhi,bhi->bh", at, at)[..., None]
        return np.sqrt(np.maximum(d, 0.0, out=d), out=d)

    total = distances(a)
    total += distances(b)
    total *= 0.5
    return total


def capsules(
    a: FloatArray, b: FloatArray, A: FloatArray, swept: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The capsules around hulls: ends of their segments and radii, NaN of one that holds nothing.

    A spheroid with semi-axes A > B lies in the capsule of radius B around the segment that reaches
    A - B to either side of its centre on its axis. What is `swept` is one already, (H,).
    """
    half = 0.5 * (b - a)
    h = np.linalg.norm(half, axis=-1)
    B = np.sqrt(np.where(h < A, (A - h) * (A + h), np.nan))
    reach = half * ((A - B) / np.where(h > 0.0, h, 1.0))[..., None]
    middle = 0.5 * (a + b)
    along = swept[:, None]
    first, last = np.where(along, a, middle - reach), np.where(along, b, middle + reach)
    return first, last, np.where(swept, A, B)


def segment_distance(p: FloatArray, q: FloatArray, r: FloatArray, s: FloatArray) -> FloatArray:
    """Between the segments pq and rs, (..., 3) each [m].

    Two segments are nearest either at an end of one of them, or where the common perpendicular of
    their lines meets both.
    """
    ends = np.minimum(
        np.minimum(to_segment(p, r, s), to_segment(q, r, s)),
        np.minimum(to_segment(r, p, q), to_segment(s, p, q)),
    )
    u, v, w = q - p, s - r, r - p
    normal = np.cross(u, v)
    square = np.einsum("...i,...i", normal, normal)
    divisor = np.where(square > 0.0, square, np.inf)
    t = np.einsum("...i,...i", np.cross(w, v), normal) / divisor
    k = np.einsum("...i,...i", np.cross(w, u), normal) / divisor
    both = (square > 0.0) & (t > 0.0) & (t < 1.0) & (k > 0.0) & (k < 1.0)
    across = np.linalg.norm(p + t[..., None] * u - r - k[..., None] * v, axis=-1)
    return np.where(both, np.minimum(across, ends), ends)
