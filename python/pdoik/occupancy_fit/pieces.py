"""Convex pieces of a link, the third level: itself, where it is made of convex parts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import QhullError

from .hulls import DECIMALS, FloatArray, Point
from .solid import Solid, areas, spread

TOLERANCE = 1e-3  # how far a piece may stand beyond its link [m]
MOST_PIECES = 40  # of a link
_SPACING = 2e-3  # of the points that a piece is measured at [m]
_FEWEST, _MOST = 1000, 20_000  # of them
_SKIN = 1e-5
"""By which a piece is thicker than its part [m]: a success may miss its clearance by a tenth of it,
and no solver knows a distance better than to rounding."""
_SURE = 5e-5  # what three samples' triangles say of less is let be [m]
_NEAREST = 64  # samples, where they say more


class Piece(NamedTuple):
    """A convex polytope fixed to a link."""

    link: str
    vertices: tuple[Point, ...]  # in the link's frame [m]
    triangles: tuple[tuple[int, int, int], ...]  # counter-clockwise from outside
    tolerance: float  # how far it stands beyond the link at most [m]


def fit_pieces(link: str, triangles: FloatArray, tolerance: float = TOLERANCE) -> list[Piece]:
    """The convex hulls of a link's connected parts, if each is that part within the tolerance.

    They hold the geometry with 0.01 mm to spare. How far they stand beyond it is measured at
    points all over their faces.

    Args:
        link: Its name.
        triangles: Its geometry, (T, 3, 3) [m].
        tolerance: How far a piece may stand beyond the link [m].

    Returns:
        None for a link that has a part which is not convex, or more than 40 parts: its capsules
        then say alone what it touches.
    """
    parts = _connected(triangles)
    if not 0 < len(parts) <= MOST_PIECES:
        return []
    solid = Solid.of(triangles)
    pieces = [_piece(link, part, solid) for part in parts]
    if any(piece is None or piece.tolerance > tolerance for piece in pieces):
        return []
    return [piece for piece in pieces if piece is not None]


def _connected(triangles: FloatArray) -> list[FloatArray]:
    """Parts of a surface that share no vertex, each (T, 3, 3)."""
    corners = np.rint(triangles.reshape(-1, 3) / 1e-7)
    _, vertex = np.unique(corners, axis=0, return_inverse=True)
    faces = vertex.reshape(-1, 3)
    count = int(faces.max(initial=-1)) + 1
    edges: NDArray[np.int_] = np.concatenate([faces[:, :2], faces[:, 1:]])
    ones = np.ones(len(edges))
    graph = coo_array((ones, (edges[:, 0], edges[:, 1])), shape=(count, count))
    labels = np.asarray(connected_components(graph, directed=False)[1])
    of_face = labels[faces[:, 0]]
    return [triangles[of_face == label] for label in np.unique(of_face)]


def _piece(link: str, part: FloatArray, solid: Solid) -> Piece | None:
    """Of a part with a volume; None for others."""
    try:
        hull = trimesh.convex.convex_hull(part.reshape(-1, 3).round(DECIMALS))
    except QhullError:
        return None
    if not hull.is_watertight or not hull.is_winding_consistent or hull.volume <= 0.0:
        return None
    hull.vertices = _swollen(hull)
    surface = np.asarray(hull.triangles)
    count = int(np.clip(areas(surface).sum() / _SPACING**2, _FEWEST, _MOST))
    beyond = _beyond(spread(surface, count)[0], solid)
    return Piece(
        link,
        tuple((float(x), float(y), float(z)) for x, y, z in hull.vertices),
        tuple((int(i), int(j), int(k)) for i, j, k in hull.faces),
        round(beyond + 5e-7, 6),
    )


def _swollen(hull: trimesh.Trimesh) -> FloatArray:
    """Its vertices, farther from its middle so that each face moves out by the skin at least."""
    middle = np.asarray(hull.center_mass)
    depths = np.einsum("fi,fi->f", hull.face_normals, hull.triangles[:, 0] - middle)
    return np.asarray(middle + (1.0 + _SKIN / depths.min()) * (hull.vertices - middle))


def _beyond(points: FloatArray, solid: Solid) -> float:
    """How far the farthest of some points is outside of a solid [m].

    To the nearest of many triangles where those of a few samples say that it is outside.
    """
    rough = solid.outside(points)
    doubtful = np.flatnonzero(rough > _SURE)
    if not len(doubtful):
        return float(rough.max(initial=0.0))
    nearest = min(_NEAREST, len(solid.owners))
    distance = rough[doubtful]
    for k in np.array_split(np.arange(len(doubtful)), 1 + len(doubtful) // 2000):
        owners = solid.owners[solid.samples.query(points[doubtful[k]], k=nearest)[1]]
        repeated = np.repeat(points[doubtful[k]], nearest, axis=0)
        closest = trimesh.triangles.closest_point(  # type: ignore[no-untyped-call]
            solid.triangles[owners.ravel()], repeated
        )
        to_each = np.linalg.norm(repeated - closest, axis=1).reshape(-1, nearest)
        distance[k] = np.minimum(distance[k], to_each.min(axis=1))
    rough[doubtful] = distance
    return float(rough.max())
