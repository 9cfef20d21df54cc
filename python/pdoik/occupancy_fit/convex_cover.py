"""Convex pieces that together hold a body which is not convex, each within a tolerance of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from .atoms import Atoms
from .beyond import Beyond
from .hulls import FloatArray
from .solid import areas, spread
from .wrap import farthest_points

_SLACK = 0.6  # of the tolerance, by which an atom may stand over another one's plane
_SEEDS = 12  # atoms that a piece may begin with
_CUTS = 12  # of a piece before it is measured again
_SPACINGS = (5e-3, 2e-3)  # of the places on a piece's faces that are measured [m]
_FEWEST, _MOST = 1000, 20_000  # of them
_CLOSE = 1e-4  # to a plane through a place that stands out: cut off too, and so always some [m]
_BUD = 5e-5 * np.concatenate([np.eye(3), -np.eye(3)])  # so that no piece is flat [m]


def convex_cover(
    body: FloatArray, beyond: Beyond, tolerance: float, most: int
) -> list[FloatArray] | None:
    """Corners of pieces, each (V, 3) [m], that hold a body's surface and its inside.

    The surface is cut into small triangles, and cubes are put inside. Two of these atoms go
    together where neither stands over the other's plane by more than a part of the tolerance, and
    what lies between them is inside: then so is their hull, but for that much. A piece is the hull
    of atoms that all go together, chosen greedily to hold most of what no piece holds yet. It is
    measured; where it stands out too far, a plane cuts off what spans that place.

    Args:
        body: A connected surface, (T, 3, 3) [m].
        beyond: Gives how far places are outside the whole link.
        tolerance: How far a piece may stand beyond it [m].
        most: None if it takes more pieces than this.
    """
    atoms = Atoms.of(body, _SLACK * tolerance)
    bare = np.ones(len(atoms.corners), dtype=bool)
    pieces: list[FloatArray] = []
    while bare.any():
        if len(pieces) >= most:
            return None
        chosen, corners = _piece(atoms, bare, beyond, tolerance)
        if len(corners):
            pieces.append(corners)
            bare[bare] = ~_held(corners, [atoms.corners[k] for k in np.flatnonzero(bare)])
        else:  # a patch that is not convex itself
            pieces += [np.concatenate([face, face[0] + _BUD]) for face in atoms.faces[chosen]]
        bare[chosen] = False
    return pieces


def _piece(
    atoms: Atoms, bare: NDArray[np.bool_], beyond: Beyond, tolerance: float
) -> tuple[int, FloatArray]:
    """A bare atom, and corners of a hull of it and many others that stands out as little as it may.

    Without corners where that atom's own hull stands out too far.
    """
    left = np.flatnonzero(bare)
    seeds = left[farthest_points(atoms.middles[left], _SEEDS)]
    grown = [atoms.piece_from(int(seed), bare) for seed in seeds]
    chosen = max(grown, key=lambda one: float(atoms.weights[one].sum()))
    while True:
        corners = [atoms.corners[k] for k in chosen]
        points = np.concatenate([*corners, corners[0][0] + _BUD])
        far = _too_far(points, beyond, tolerance)
        if not len(far):
            return int(chosen[0]), points
        if len(chosen) == 1:
            return int(chosen[0]), np.empty((0, 3))
        first = np.cumsum([0, *map(len, corners[:-1])])
        weights = atoms.weights[chosen]
        chosen = chosen[_spared(points[: -len(_BUD)], first, weights, far)]


def _spared(
    points: FloatArray, first: NDArray[np.int_], weights: FloatArray, far: FloatArray
) -> NDArray[np.bool_]:
    """Which atoms are left when planes through places have cut them off, with least of the atoms.

    Args:
        points: The atoms' corners, (P, 3) [m].
        first: Where each atom's begin, (A,).
        weights: The atoms', (A,).
        far: The places, the worst one first, (N, 3) [m].
    """
    spared = np.ones(len(first), dtype=bool)
    random = np.random.default_rng(0)
    far = far[:_CUTS]
    while len(far):
        at = far[0]
        normals = _SPHERE
        away = (points - at).astype(np.float32)
        for turn in (0.3, 0.1, 0.03, None):
            beyond = _any(away @ normals.T.astype(np.float32) > -_CLOSE, first)
            lost = (weights * spared) @ beyond
            best = int(np.argmin(lost))
            normal, cut = normals[best], beyond[:, best]
            if turn is not None:
                turned = normal + turn * random.normal(size=(40, 3))
                turned /= np.linalg.norm(turned, axis=1, keepdims=True)
                normals = np.concatenate([normal[None], turned])
        if (spared & ~cut).any():
            spared &= ~cut
            far = far[(far - at) @ normal < -1e-9]
        else:
            spared = np.arange(len(spared)) == int(np.argmax(weights * spared))
            break
    return spared


def _any(of_points: NDArray[np.bool_], first: NDArray[np.int_]) -> NDArray[np.bool_]:
    """Whether any of each atom's points is set, (A, D)."""
    bits = np.bitwise_or.reduceat(np.packbits(of_points, axis=1), first, axis=0)
    return np.unpackbits(bits, axis=1, count=of_points.shape[1]).view(np.bool_)


def _too_far(points: FloatArray, beyond: Beyond, tolerance: float) -> FloatArray:
    """Places on a hull that stand out too far, of each face the worst, worst first, (N, 3)."""
    surface = points[ConvexHull(points).simplices]
    for spacing in _SPACINGS:
        count = int(np.clip(areas(surface).sum() / spacing**2, _FEWEST, _MOST))
        on, faces = spread(surface, count)
        out = beyond(on, more_than=tolerance)
        far = np.flatnonzero(out)
        if len(far):
            far = far[np.argsort(-out[far])]
            _, first = np.unique(faces[far], return_index=True)
            return np.asarray(on[far[np.sort(first)]])
    return np.empty((0, 3))


def _sphere(count: int) -> FloatArray:
    """Directions evenly over the sphere, (count, 3)."""
    z = (2 * np.arange(count) + 1) / count - 1
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    across = np.sqrt(1 - z**2)
    return np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)


_SPHERE = _sphere(200)


def _held(piece: FloatArray, groups: list[FloatArray]) -> NDArray[np.bool_]:
    """Which groups of places a piece holds."""
    planes = ConvexHull(piece).equations
    counts = np.array([len(group) for group in groups])
    out = (np.concatenate(groups) @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    return np.asarray(np.maximum.reduceat(out, first) <= 1e-9)
