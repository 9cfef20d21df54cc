"""Distances of points to hulls and to solids by their definition, in double precision."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._core import Shape
from .._distance_fields import least_along
from .values import FloatArray

_BISECTIONS = 48
_FIRST_LOOK = 64  # points of a hull
_SHRINKS = 60  # of an interval to 0.62 of itself: to 3e-13


def to_capsule(points: FloatArray, a: FloatArray, b: FloatArray, radius: float) -> FloatArray:
    """Distances of points to what lies within a radius of a segment, (N,), negative inside [m]."""
    along = b - a
    t = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - a - t[:, None] * along, axis=1) - radius)


def to_spheroid(points: FloatArray, a: FloatArray, b: FloatArray, semi_major: float) -> FloatArray:
    """Distances of points to a spheroid by its foci and half axis, (N,), negative inside [m].

    In the plane of a point and the foci: the nearest point of the ellipse (A cos t, B sin t), found
    by bisection of the slope of the squared distance in the quadrant of the point.
    """
    A, half = semi_major, 0.5 * float(np.linalg.norm(b - a))
    middle = 0.5 * (a + b)
    if half < 1e-12 * A:
        return np.asarray(np.linalg.norm(points - middle, axis=1) - A)
    if half >= A:
        return np.full(len(points), np.inf)
    B = float(np.sqrt((A - half) * (A + half)))
    axis = (b - a) / (2.0 * half)
    x = (points - middle) @ axis
    y = np.linalg.norm(points - middle - x[:, None] * axis, axis=1)
    x = np.abs(x)
    low, high = np.zeros_like(x), np.full_like(x, np.pi / 2)
    for _ in range(_BISECTIONS):
        t = 0.5 * (low + high)
        slope = x * A * np.sin(t) - y * B * np.cos(t) - half * half * np.sin(t) * np.cos(t)
        low, high = np.where(slope < 0.0, t, low), np.where(slope < 0.0, high, t)
    at = [0.5 * (low + high), np.zeros_like(x), np.full_like(x, np.pi / 2)]
    gap = np.min([np.hypot(x - A * np.cos(t), y - B * np.sin(t)) for t in at], axis=0)
    return np.asarray(np.where((x / A) ** 2 + (y / B) ** 2 < 1.0, -gap, gap))


def to_hull(
    points: FloatArray, a: FloatArray, b: FloatArray, size: float, swept: bool, least: float
) -> float:
    """Least distance of points to a hull, if it is less than `least` [m].

    Only points that may be so near are looked at.
    """
    if len(points) == 0:
        return least
    centres, radii = points[:, :3], points[:, 3]
    if swept:
        return float((to_capsule(centres, a, b, size) - radii).min())
    if float(np.linalg.norm(b - a)) >= 2.0 * size:
        return least
    # Half the sum of distances to the foci, less the semi-major axis, is no more than the distance.
    to = [np.linalg.norm(centres - focus, axis=1) for focus in (a, b)]
    bound = 0.5 * (to[0] + to[1]) - size - radii
    first = np.argsort(bound)[:_FIRST_LOOK]
    near = min(least, float((to_spheroid(centres[first], a, b, size) - radii[first]).min()))
    rest = (bound <= near) | (bound + radii <= 0.0)
    return min(
        near, float((to_spheroid(centres[rest], a, b, size) - radii[rest]).min(initial=np.inf))
    )


def segment_to_shape(a: FloatArray, b: FloatArray, shape: Shape, enough: float = np.inf) -> float:
    """Least signed distance of a segment's points to a solid [m].

    Where it is certainly no less than `enough`, it is some number that is no less.
    """
    T = np.linalg.inv(shape.T_base_shape)
    a, b = T[:3, :3] @ a + T[:3, 3], T[:3, :3] @ b + T[:3, 3]
    if shape.kind == "mesh":
        return _segment_to_mesh(a, b, shape.vertices[shape.triangles])
    if shape.kind == "distance_field":
        assert shape.cell is not None
        return least_along(shape.values, shape.cell, a, b)
    if shape.kind == "boxes":
        boxes = zip(shape.vertices[0::2], shape.vertices[1::2], strict=True)
        return min(_least_along(a, b, _to_box(low, high), enough) for low, high in boxes)
    return _least_along(a, b, _signed_distance(shape), enough)


def _least_along(
    a: FloatArray, b: FloatArray, distance: Callable[[FloatArray], float], enough: float
) -> float:
    """Least distance of a segment's points, along which a distance is convex."""
    bound = distance(0.5 * (a + b)) - 0.5 * float(np.linalg.norm(b - a))
    if bound >= enough:
        return bound
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    low, high = 0.0, 1.0
    ends = [float(distance(a)), float(distance(b))]
    for _ in range(_SHRINKS):
        left, right = high - golden * (high - low), low + golden * (high - low)
        if distance(a + left * (b - a)) < distance(a + right * (b - a)):
            high = right
        else:
            low = left
    return min(*ends, float(distance(a + 0.5 * (low + high) * (b - a))))


def _signed_distance(shape: Shape) -> Callable[[FloatArray], float]:
    """Signed distance function of a point in the shape's frame, (3,) [m]."""
    size = list(shape.size)
    match shape.kind:
        case "sphere":
            return lambda p: float(np.linalg.norm(p) - size[0])
        case "half_space":
            return lambda p: float(p[2])
        case "box":
            return lambda p: _corner(np.abs(p) - 0.5 * np.array(size))
        case "cylinder":
            return lambda p: _corner(
                np.array([np.hypot(p[0], p[1]) - size[0], abs(p[2]) - 0.5 * size[1]])
            )
        case "capsule":
            end = np.array([0.0, 0.0, 0.5 * size[1]])
            return lambda p: float(to_capsule(p[None], -end, end, size[0])[0])
    return to_mesh(shape.vertices, shape.triangles)


def _to_box(low: FloatArray, high: FloatArray) -> Callable[[FloatArray], float]:
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return lambda p: _corner(np.abs(p - middle) - half)


def _segment_to_mesh(a: FloatArray, b: FloatArray, corners: FloatArray) -> float:
    """Distance of a segment to triangles (T, 3, 3): negative where it crosses one, or is inside."""
    A, B, C = corners.transpose(1, 0, 2)
    normals = np.cross(B - A, C - A)
    lengths = np.linalg.norm(normals, axis=1)
    A, B, C, normals = (each[lengths > 0.0] for each in (A, B, C, normals))
    normals /= lengths[lengths > 0.0][:, None]

    def below(points: FloatArray) -> NDArray[np.bool_]:
        """Whether points (T, 3) have their feet in the triangles."""
        inside = np.ones(len(A), dtype=bool)
        for start, end in ((A, B), (B, C), (C, A)):
            across = np.cross(end - start, points - start)
            inside &= np.einsum("ti,ti->t", across, normals) >= 0.0
        return inside

    above = [np.einsum("ti,ti->t", end - A, normals) for end in (a, b)]
    through = (above[0] < 0.0) != (above[1] < 0.0)
    share = above[0] / np.where(through, above[0] - above[1], 1.0)
    through &= below(a + np.where(through, share, 0.0)[:, None] * (b - a))
    if through.any():
        return -float(np.minimum(*np.abs(above))[through].max())
    edges = [_segments_apart(a, b, one, two).min() for one, two in ((A, B), (B, C), (C, A))]
    ends = [
        np.abs(height)[below(np.tile(end, (len(A), 1)))].min(initial=np.inf)
        for end, height in zip((a, b), above, strict=True)
    ]
    least = float(min(*edges, *ends))
    return -least if abs(windings(a, A, B, C)) > 0.5 else least


def _segments_apart(
    a: FloatArray, b: FloatArray, starts: FloatArray, ends: FloatArray
) -> FloatArray:
    """Distances from one segment to others (T, 3), (T,): inside of both, or from an end of one."""
    u, v, w = b - a, ends - starts, a - starts
    uu, uv, vv = float(u @ u), v @ u, np.einsum("ti,ti->t", v, v)
    uw, vw = w @ u, np.einsum("ti,ti->t", v, w)
    size = uu * vv - uv * uv
    flat = size <= 1e-14 * uu * vv
    s = np.clip(np.where(flat, 0.0, (uv * vw - vv * uw) / np.where(flat, 1.0, size)), 0.0, 1.0)
    t = np.clip(np.where(flat, 0.0, (uu * vw - uv * uw) / np.where(flat, 1.0, size)), 0.0, 1.0)
    lines = np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1)
    of_ends = [
        np.linalg.norm(
            p
            - starts
            - np.clip(np.einsum("ti,ti->t", p - starts, v) / np.maximum(vv, 1e-300), 0, 1)[:, None]
            * v,
            axis=1,
        )
        for p in (a, b)
    ]
    of_others = [to_capsule(points, a, b, 0.0) for points in (starts, ends)]
    return np.asarray(np.min([lines, *of_ends, *of_others], axis=0))


def windings(p: FloatArray, A: FloatArray, B: FloatArray, C: FloatArray) -> float:
    """How often triangles go round a point (van Oosterom and Strackee, 1983)."""
    a, b, c = A - p, B - p, C - p
    la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    volume = np.einsum("ti,ti->t", a, np.cross(b, c))
    rest = (
        la * lb * lc
        + np.einsum("ti,ti->t", a, b) * lc
        + np.einsum("ti,ti->t", b, c) * la
        + np.einsum("ti,ti->t", c, a) * lb
    )
    return float(np.arctan2(volume, rest).sum() / (2.0 * np.pi))


def _corner(beyond: FloatArray) -> float:
    """Outside of a product of intervals, or how deep inside."""
    return float(np.linalg.norm(np.maximum(beyond, 0.0)) + min(float(beyond.max()), 0.0))


def above_faces(
    points: FloatArray, vertices: FloatArray, triangles: NDArray[np.int32]
) -> FloatArray:
    """Heights of points (N, 3) above the planes of a mesh's triangles, (N, T) [m]."""
    normals, offsets = _planes(*(vertices[triangles[:, k]] for k in range(3)))
    return np.asarray(points @ normals.T - offsets)


def _planes(A: FloatArray, B: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Normals and offsets; everything is below a triangle of no area."""
    normals = np.cross(B - A, C - A)
    lengths = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(lengths, 1e-300)[:, None]
    return normals, np.where(lengths > 0.0, np.einsum("ti,ti->t", normals, A), np.inf)


def to_mesh(vertices: FloatArray, triangles: NDArray[np.int32]) -> Callable[[FloatArray], float]:
    """Signed distance function of a point to a closed convex mesh [m]."""
    A, B, C = (vertices[triangles[:, k]] for k in range(3))
    normals, offsets = _planes(A, B, C)

    def distance(p: FloatArray) -> float:
        heights = normals @ p - offsets
        if heights.max() <= 0.0:
            return float(heights.max())
        foot = p - heights[:, None] * normals
        inside = np.ones(len(A), dtype=bool)
        least = np.inf
        for start, end in ((A, B), (B, C), (C, A)):
            edge = end - start
            inside &= np.einsum("ti,ti->t", np.cross(edge, foot - start), normals) >= 0.0
            t = np.clip(
                np.einsum("ti,ti->t", p - start, edge) / np.einsum("ti,ti->t", edge, edge), 0, 1
            )
            least = min(least, float(np.linalg.norm(p - start - t[:, None] * edge, axis=1).min()))
        return float(min(least, np.abs(heights[inside]).min(initial=np.inf)))

    return distance
