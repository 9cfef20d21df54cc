"""Convex pieces of a link, the third level: the link itself."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import trimesh
from scipy.spatial import ConvexHull, QhullError

from .beyond import Beyond
from .convex_cover import convex_cover
from .hulls import FloatArray, Point
from .solid import areas, spread

TOLERANCE = 1e-3  # how far a piece may stand beyond its link [m]
MOST_PIECES = 120  # of a link
_COARSER = (1, 2, 4, 8)  # times the tolerance, where it takes more
_STRICT = (0.8, 0.6, 0.4)  # of the tolerance, for pieces that are measured again
_SPACING = 2e-3  # of the points that a piece is measured at [m]
_FEWEST, _MOST = 1000, 20_000  # of them
_SKIN = 1.1e-5
"""How much a piece is thicker than its part [m]: a success may miss its clearance by a tenth of it,
and rounding takes less than another."""
_DIGITS = 6  # of its vertices [um]
_THIN = 5e-3  # from its middle to its nearest face, a thin piece [m]


class Piece(NamedTuple):
    """A convex polytope fixed to a link."""

    link: str
    vertices: tuple[Point, ...]  # in the link's frame [m]
    triangles: tuple[tuple[int, int, int], ...]  # counter-clockwise from outside
    tolerance: float  # how far it stands beyond the link at most [m]


def fit_pieces(link: str, triangles: FloatArray, tolerance: float = TOLERANCE) -> list[Piece]:
    """Convex pieces that together are a link, within the tolerance.

    The convex hull of a connected part, where it is that part within the tolerance; elsewhere
    several that cover it (`convex_cover`). They hold the geometry with 0.01 mm to spare. How far
    they stand beyond it is measured at points all over their faces. Of a link that takes more than
    120 they may stand out twice as far, or four or eight times: each says by how much it does.

    Args:
        link: Its name.
        triangles: Its geometry, (T, 3, 3) [m].
        tolerance: How far a piece may stand beyond the link [m].

    Returns:
        None for a link that takes more than 120 even so, or has a scrap too thin for a hull: its
        capsules then say alone what it touches.
    """
    beyond = Beyond(triangles)
    if len(beyond.parts) > MOST_PIECES:
        return []
    largest_first = sorted(beyond.parts, key=len, reverse=True)
    parts = [(part, _piece(link, part.reshape(-1, 3), beyond)) for part in largest_first]
    for times in _COARSER:
        pieces = _within(link, parts, beyond, times * tolerance)
        if pieces is not None:
            return pieces
    return []


def _within(
    link: str, parts: list[tuple[FloatArray, Piece | None]], beyond: Beyond, tolerance: float
) -> list[Piece] | None:
    """Pieces within a tolerance, of parts and the hull of each, if it has one.

    None if it takes too many, or one is too thin for a hull.
    """
    pieces: list[Piece] = []
    for part, whole in parts:
        found: list[Piece] | None
        if whole is not None and whole.tolerance <= tolerance:
            found = [whole]
        else:
            found = _covering(link, part, beyond, tolerance, MOST_PIECES - len(pieces))
        if found is None:
            return None
        pieces += found
    pieces = _needed(pieces)
    return pieces if len(pieces) <= MOST_PIECES else None


def _covering(
    link: str, part: FloatArray, beyond: Beyond, tolerance: float, most: int
) -> list[Piece] | None:
    """Pieces that cover a part; None if it takes more than most, or one is too thin for a hull.

    Their faces are measured at other places than while they were made: where one then stands out
    farther, all are made again by less.
    """
    pieces: list[Piece] = []
    for share in _STRICT:
        cover = convex_cover(part, beyond, share * tolerance, most)
        if cover is None:
            return None
        pieces = []
        for corners in cover:
            piece = _piece(link, corners, beyond) or _piece(link, _thick(corners), beyond)
            if piece is None:
                return None
            pieces.append(piece)
        if all(piece.tolerance <= tolerance for piece in pieces):
            break
    return pieces


def _piece(link: str, points: FloatArray, beyond: Beyond) -> Piece | None:
    """The hull of points (N, 3), if it has a volume."""
    hull = _hull(points)
    if hull is None:
        return None
    hull = _swollen(hull)
    if hull is None:
        return None
    surface = np.asarray(hull.triangles)
    count = int(np.clip(areas(surface).sum() / _SPACING**2, _FEWEST, _MOST))
    out = beyond.most(spread(surface, count)[0])
    return Piece(
        link,
        tuple((float(x), float(y), float(z)) for x, y, z in hull.vertices),
        tuple((int(i), int(j), int(k)) for i, j, k in hull.faces),
        round(out + 5e-7, 6),
    )


def _hull(points: FloatArray) -> Any:
    """The hull of points, which are rounded, if it has a volume; or None."""
    try:
        corners = points[ConvexHull(points).vertices].round(_DIGITS)
        hull = trimesh.convex.convex_hull(corners)
    except QhullError:
        return None
    closed = hull.is_watertight and hull.is_winding_consistent and hull.volume > 0.0
    return hull if closed else None


def _needed(pieces: list[Piece]) -> list[Piece]:
    """Pieces without those that lie in another one, as hidden parts do."""
    kept: list[Piece] = []
    planes: list[FloatArray] = []
    for piece in sorted(pieces, key=lambda one: -ConvexHull(one.vertices).volume):
        corners = np.array(piece.vertices)
        if not any((corners @ p[:, :3].T + p[:, 3]).max() <= 0.0 for p in planes):
            kept.append(piece)
            planes.append(ConvexHull(corners).equations)
    return kept


def _swollen(hull: Any) -> Any:
    """The hull, larger by the skin at least.

    Its vertices move away from its middle. Of a thin one that would move far ones too far: there
    it is the hull of octahedra about them.
    """
    middle = np.asarray(hull.center_mass)
    depth = float(np.einsum("fi,fi->f", hull.face_normals, hull.triangles[:, 0] - middle).min())
    if depth > _THIN:
        return _hull(middle + (1.0 + _SKIN / depth) * (hull.vertices - middle))
    return _hull(_thick(np.asarray(hull.vertices)))


def _thick(points: FloatArray) -> FloatArray:
    """Corners of octahedra about points, (6 N, 3), that hold balls as thick as the skin."""
    octahedron = np.sqrt(3) * _SKIN * np.concatenate([np.eye(3), -np.eye(3)])
    return np.asarray((points[:, None] + octahedron).reshape(-1, 3))
