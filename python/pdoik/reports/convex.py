"""Distances between convex bodies, by what their corners are in one direction after the other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from .._core import Shape
from .distances import windings
from .values import FloatArray

_ROUNDS = 100
_CLOSE = 1e-12  # share of a squared distance that the next round would gain
_BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


@dataclass(frozen=True, slots=True)
class Body:
    """The hull of corners, or of a disc's rims, with all that lies within a radius of it.

    Attributes:
        corners: (N, 3) [m].
        radius: [m].
        rim: About the corners, discs of this radius across `axis` [m].
        axis: A unit vector.
        normals: Of its faces, as far as they are known, (F, 3).
    """

    corners: FloatArray
    radius: float = 0.0
    rim: float = 0.0
    axis: FloatArray | None = None
    normals: FloatArray | None = None

    def farthest(self, direction: FloatArray) -> FloatArray:
        """Point, without the radius, that lies farthest in a direction, (3,) [m]."""
        found = self.corners[int((self.corners @ direction).argmax())]
        if self.axis is None:
            return np.asarray(found)
        across = direction - (direction @ self.axis) * self.axis
        return np.asarray(found + self.rim * across / max(float(np.linalg.norm(across)), 1e-300))

    def reach(self, directions: FloatArray) -> FloatArray:
        """How far it reaches in directions (D, 3) without the radius, from the origin, (D,) [m]."""
        far = (directions @ self.corners.T).max(axis=1)
        if self.axis is None:
            return np.asarray(far)
        across = directions - np.outer(directions @ self.axis, self.axis)
        return np.asarray(far + self.rim * np.linalg.norm(across, axis=1))


def piece(vertices: FloatArray, triangles: NDArray[np.int32], T: FloatArray) -> Body:
    """A convex mesh at a pose."""
    corners = vertices @ T[:3, :3].T + T[:3, 3]
    A, B, C = (corners[triangles[:, k]] for k in range(3))
    normals = np.cross(B - A, C - A)
    lengths = np.linalg.norm(normals, axis=1)
    kept = lengths > 0.0
    return Body(corners, normals=normals[kept] / lengths[kept][:, None])


def to_shape(body: Body, shape: Shape, enough: float = np.inf) -> float:
    """Least distance of a body to a shape, which is no distance field: as `apart` [m]."""
    T = shape.T_base_shape
    if shape.kind == "half_space":
        up = T[:3, 2]
        return float((body.farthest(-up) - T[:3, 3]) @ up) - body.radius
    if shape.kind != "mesh":
        return min(apart(body, other, enough) for other in _bodies(shape))
    corners = shape.vertices[shape.triangles] @ T[:3, :3].T + T[:3, 3]
    reach = max(enough, 0.0) + body.radius + body.rim
    low, high = body.corners.min(axis=0) - reach, body.corners.max(axis=0) + reach
    near = ((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(axis=1)
    A, B, C = corners.transpose(1, 0, 2)
    if abs(windings(body.corners[0], A, B, C)) > 0.5:  # wholly inside, or through the surface
        return -float(np.linalg.norm(A - body.corners[0], axis=1).min()) - body.radius
    return min((apart(body, Body(each), enough) for each in corners[near]), default=enough)


def _bodies(shape: Shape) -> list[Body]:
    """The convex bodies that a shape is."""
    T, size = shape.T_base_shape, list(shape.size)
    turn, at = T[:3, :3], T[:3, 3]
    match shape.kind:
        case "sphere":
            return [Body(at[None], size[0])]
        case "capsule":
            return [Body(at + np.outer([-0.5, 0.5], size[1] * turn[:, 2]), size[0])]
        case "cylinder":
            ends = at + np.outer([-0.5, 0.5], size[1] * turn[:, 2])
            return [Body(ends, rim=size[0], axis=turn[:, 2], normals=turn[:, 2:].T)]
        case "box":
            return [Body(_BOX * size @ turn.T + at, normals=turn.T)]
        case "boxes":
            lows, highs = shape.vertices[0::2], shape.vertices[1::2]
            sides = zip(0.5 * (lows + highs), highs - lows, strict=True)
            return [Body((m + _BOX * side) @ turn.T + at, normals=turn.T) for m, side in sides]
        case "convex_mesh":
            return [piece(shape.vertices, shape.triangles, T)]
    raise ValueError(f"shape {shape.name!r} is a {shape.kind}, which is not made of convex bodies")


def apart(a: Body, b: Body, enough: float = np.inf) -> float:
    """Least distance of two bodies, or how deep they are in each other, negative [m].

    Gilbert, Johnson and Keerthi's method. Where the distance is certainly no less than `enough`, it
    is some number that is no less. The depth is the least in the directions that were looked in and
    those of faces: no less than it is.
    """
    radii = a.radius + b.radius
    nearest = a.corners.mean(axis=0) - b.corners.mean(axis=0)
    simplex = np.empty((0, 3))
    looked: list[FloatArray] = []
    for _ in range(_ROUNDS):
        square = float(nearest @ nearest)
        if square == 0.0:
            break
        direction = nearest / np.sqrt(square)
        looked.append(direction)
        corner = a.farthest(-nearest) - b.farthest(nearest)
        bound = float(corner @ direction)
        if bound - radii >= enough:
            return bound - radii
        if bound > 0.0 and square - bound * np.sqrt(square) <= _CLOSE * square:
            return float(np.sqrt(square)) - radii
        if len(simplex) and (np.abs(simplex - corner).max(axis=1) == 0.0).any():
            return float(np.sqrt(square)) - radii
        simplex, nearest = _nearest_to_origin(np.concatenate([simplex, corner[None]]))
        if len(simplex) == 4:
            break
    for body in (a, b):
        if body.normals is not None:
            looked += [*body.normals, *-body.normals]
    if not looked:
        return -radii
    directions = np.array(looked)
    return float((-a.reach(-directions) - b.reach(directions)).max()) - radii


def _nearest_to_origin(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The fewest of up to four corners whose hull has their hull's point nearest to 0, and it."""
    best, least = (corners[-1:], corners[-1]), np.inf
    for count in range(1, len(corners) + 1):
        for some in combinations(range(len(corners)), count):
            first, *others = corners[list(some)]
            edges = np.array(others).reshape(-1, 3) - first
            shares = np.linalg.lstsq(edges.T, -first, rcond=1e-12)[0]
            if (shares < 0.0).any() or shares.sum() > 1.0:
                continue
            point = first + shares @ edges
            if float(point @ point) < least * (1.0 - 1e-14):
                best, least = (corners[list(some)], point), float(point @ point)
    return best
