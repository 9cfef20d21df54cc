"""How far a point is from a solid, and the place on the solid's surface that is nearest to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import trimesh

import pdoik
from pdoik._hulls import PlacedCapsule, PlacedHull, PlacedSpheroid

from .field_surface import field_distance, field_surface

FloatArray = npt.NDArray[np.float64]
Surface = Callable[[FloatArray], tuple[float, FloatArray]]
"""Function of a point (3,): its distance, negative inside [m], and the nearest place (3,)."""


def ball_surface(center: FloatArray, radius: float) -> Surface:
    def to_ball(point: FloatArray) -> tuple[float, FloatArray]:
        distance = float(np.linalg.norm(point - center))
        outward = (point - center) / distance if distance > 0 else np.array([0.0, 0.0, 1.0])
        return distance - radius, center + radius * outward

    return to_ball


def part_surface(part: PlacedHull | pdoik.Shape) -> Surface:
    """Surface in the base frame."""
    if isinstance(part, PlacedCapsule):
        return segment_surface(part.a, part.b, part.radius)
    if isinstance(part, PlacedSpheroid):
        return _spheroid_surface(part)
    return shape_surface(part)


def part_distance(part: PlacedHull | pdoik.Shape) -> Callable[[FloatArray], float]:
    """The distance alone, which is found sooner of a distance field."""
    if isinstance(part, pdoik.Shape) and part.kind == "distance_field":
        T_shape_base = np.linalg.inv(part.T_base_shape)
        of_field = field_distance(part)
        return lambda point: of_field(T_shape_base[:3, :3] @ point + T_shape_base[:3, 3])
    surface = part_surface(part)
    return lambda point: surface(point)[0]


def shape_surface(shape: pdoik.Shape) -> Surface:
    """Surface in the base frame."""
    T = np.asarray(shape.T_base_shape)
    R, t, size = T[:3, :3], T[:3, 3], np.array(shape.size)
    match shape.kind:
        case "box":
            local = _box(size / 2)
        case "sphere":
            local = ball_surface(np.zeros(3), size[0])
        case "cylinder":
            local = _cylinder(size[0], size[1] / 2)
        case "capsule":
            end = np.array([0.0, 0.0, size[1] / 2])
            local = segment_surface(-end, end, size[0])
        case "half_space":
            local = _half_space
        case "boxes":
            local = _boxes(np.asarray(shape.vertices))
        case "distance_field":
            local = field_surface(shape)
        case "mesh":
            local = _thin(np.asarray(shape.vertices)[np.asarray(shape.triangles)])
        case _:
            local = _mesh(np.asarray(shape.vertices)[np.asarray(shape.triangles)])

    def to_shape(point: FloatArray) -> tuple[float, FloatArray]:
        distance, place = local(R.T @ (point - t))
        return distance, R @ place + t

    return to_shape


def _box(half: FloatArray) -> Surface:
    def to_box(point: FloatArray) -> tuple[float, FloatArray]:
        place = np.clip(point, -half, half)
        distance = float(np.linalg.norm(point - place))
        if distance > 0:
            return distance, place
        depth = half - np.abs(point)
        axis = int(depth.argmin())
        place[axis] = np.copysign(half[axis], point[axis])
        return -float(depth[axis]), place

    return to_box


def _cylinder(radius: float, half: float) -> Surface:
    section = _box(np.array([radius, half]))  # in the plane through the axis

    def to_cylinder(point: FloatArray) -> tuple[float, FloatArray]:
        out = float(np.hypot(point[0], point[1]))
        outward = point[:2] / out if out > 0 else np.array([1.0, 0.0])
        distance, (r, z) = section(np.array([out, point[2]]))
        return distance, np.array([*(r * outward), z])

    return to_cylinder


def segment_surface(a: FloatArray, b: FloatArray, radius: float) -> Surface:
    v = b - a

    def to_capsule(point: FloatArray) -> tuple[float, FloatArray]:
        t = float(np.clip((point - a) @ v / max(float(v @ v), 1e-300), 0.0, 1.0))
        return ball_surface(a + t * v, radius)(point)

    return to_capsule


def _spheroid_surface(hull: PlacedSpheroid) -> Surface:
    if np.linalg.norm(hull.focus_b - hull.focus_a) < 1e-9:
        return ball_surface(hull.focus_a, hull.semi_major)

    def to_spheroid(point: FloatArray) -> tuple[float, FloatArray]:
        place = onto_spheroid(hull, point)
        sign = np.sign(hull.gap(point[None])[0])
        return float(sign * np.linalg.norm(point - place)), place

    return to_spheroid


def onto_spheroid(hull: PlacedSpheroid, point: FloatArray) -> FloatArray:
    """The nearest point of a spheroid, of different foci, to one outside of it."""
    center = (hull.focus_a + hull.focus_b) / 2
    half = (hull.focus_b - hull.focus_a) / 2
    c = float(np.linalg.norm(half))
    axis = half / c
    z = float((point - center) @ axis)
    out = point - center - z * axis
    r = float(np.linalg.norm(out))
    major, minor = hull.semi_major**2, hull.semi_major**2 - c**2
    low, high = -minor, hull.semi_major * float(np.hypot(z, r))
    for _ in range(60):  # (a z / (t + a^2))^2 + (b r / (t + b^2))^2 = 1 falls with t
        t = (low + high) / 2
        inside = major * (z / (t + major)) ** 2 + minor * (r / (t + minor)) ** 2 < 1
        low, high = (low, t) if inside else (t, high)
    return np.asarray(center + major * z / (high + major) * axis + minor / (high + minor) * out)


def _half_space(point: FloatArray) -> tuple[float, FloatArray]:
    return float(point[2]), np.array([point[0], point[1], 0.0])


def _boxes(corners: FloatArray) -> Surface:
    """Surface of several boxes, by the lowest and the highest corner of each, (2 N, 3)."""
    middles, halves = (corners[1::2] + corners[0::2]) / 2, (corners[1::2] - corners[0::2]) / 2

    def to_boxes(point: FloatArray) -> tuple[float, FloatArray]:
        outside = np.maximum(np.abs(point - middles) - halves, 0)
        nearest = int((outside**2).sum(axis=1).argmin())
        distance, place = _box(halves[nearest])(point - middles[nearest])
        return distance, place + middles[nearest]

    return to_boxes


def _thin(triangles: FloatArray) -> Surface:
    """Surface of triangles without thickness, (T, 3, 3)."""
    middles = triangles.mean(axis=1)
    reaches = np.linalg.norm(triangles - middles[:, None], axis=2).max(axis=1)

    def to_thin(point: FloatArray) -> tuple[float, FloatArray]:
        apart = np.linalg.norm(middles - point, axis=1)
        near = triangles[apart - reaches <= (apart + reaches).min()]  # one of these is nearest
        points = np.tile(point, (len(near), 1))
        places: FloatArray = trimesh.triangles.closest_point(  # type: ignore[no-untyped-call]
            near, points
        )
        distances = np.linalg.norm(places - point, axis=1)
        nearest = int(distances.argmin())
        return float(distances[nearest]), places[nearest]

    return to_thin


def _mesh(triangles: FloatArray) -> Surface:
    """Surface of a closed convex mesh, (T, 3, 3)."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)

    def to_mesh(point: FloatArray) -> tuple[float, FloatArray]:
        heights = ((point - triangles[:, 0]) * normals).sum(axis=1)
        highest = int(heights.argmax())
        if heights[highest] <= 0:
            return float(heights[highest]), point - heights[highest] * normals[highest]
        return _thin(triangles)(point)

    return to_mesh
