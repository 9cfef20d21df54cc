"""How far places are outside a link, to a thousandth of a millimetre."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from .hulls import FloatArray
from .solid import Solid
from .winding import encloses

_SURE = 5e-5  # what three samples' triangles say of less is let be [m]
_NEAREST = 64  # samples, where they say more
_STRAIGHT = 1.0 - 1e-9  # cosine to a triangle's normal; over an edge of it is less
_SPACING = 4e-3  # of places along each triangle [m]
_FAR = 5e-4  # from where all triangles are asked [m]
_PAIRS = 2_000_000  # of places and triangles at a time
_CHUNK = 2000  # places at a time


class Beyond:
    """Distances from a link's solid: its parts, each with what it encloses."""

    def __init__(self, triangles: FloatArray) -> None:
        self.solid = Solid.of(triangles)
        edges = triangles[:, 1:] - triangles[:, :1]
        normals = np.cross(edges[:, 0], edges[:, 1])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self._normals = normals / np.maximum(length, np.finfo(float).tiny)
        of = labels(triangles)
        self.parts = [triangles[of == label] for label in np.unique(of)]
        self._outward = np.array([outward(part) for part in self.parts])[of]
        self._middles = triangles.mean(axis=1)
        self._radii = np.linalg.norm(triangles - self._middles[:, None], axis=2).max(axis=1)
        lines, owners = _along(triangles)
        self._owners = np.concatenate([self.solid.owners, owners])
        self._samples = cKDTree(np.concatenate([self.solid.samples.data, lines]))

    def __call__(self, places: FloatArray) -> FloatArray:
        """Of places (N, 3), 0 inside, (N,) [m].

        To the nearest of many triangles where those of a few samples say that it is outside.
        """
        rough = self.solid.outside(places)
        doubtful = np.flatnonzero(rough > _SURE)
        for k in np.array_split(doubtful, 1 + len(doubtful) // _CHUNK):
            rough[k] = np.minimum(rough[k], self._distance(places[k]))
        return rough

    def _distance(self, places: FloatArray) -> FloatArray:
        nearest = min(_NEAREST, len(self._owners))
        owners = self._owners[self._samples.query(places, k=nearest)[1]]
        repeated = np.repeat(places, nearest, axis=0)
        closest = trimesh.triangles.closest_point(  # type: ignore[no-untyped-call]
            self.solid.triangles[owners.ravel()], repeated
        )
        away = (repeated - closest).reshape(-1, nearest, 3)
        distance = np.linalg.norm(away, axis=2)
        found = self._nearer(places, distance.min(axis=1))
        # Straight under the nearest triangle a place is inside; far over it, it may be under a
        # surface that runs on inside the body.
        rows, nearest = np.arange(len(places)), distance.argmin(axis=1)
        own = owners[rows, nearest]
        over = np.einsum("ni,ni->n", away[rows, nearest], self._normals[own]) * self._outward[own]
        straight = np.abs(over) > _STRAIGHT * found
        straight &= distance[rows, nearest] <= found  # else another triangle is nearer
        inside = straight & (over < 0)
        doubtful = np.logical_not(inside)
        if len(self.parts) == 1:  # else it may be inside another one
            doubtful &= np.logical_not(straight & (found < _FAR))
        found[inside] = 0.0
        found[doubtful] *= np.logical_not(self._encloses(places[doubtful]))
        return np.asarray(found)

    def _nearer(self, places: FloatArray, found: FloatArray) -> FloatArray:
        """Distances found, or less where another triangle is nearer than those of the samples."""
        far = np.flatnonzero(found > _FAR)
        for rows in np.array_split(far, 1 + len(far) * len(self._middles) // _PAIRS):
            gap = cdist(places[rows], self._middles) - self._radii
            row, triangle = np.nonzero(gap < found[rows, None])
            closest = trimesh.triangles.closest_point(  # type: ignore[no-untyped-call]
                self.solid.triangles[triangle], places[rows[row]]
            )
            np.minimum.at(found, rows[row], np.linalg.norm(places[rows[row]] - closest, axis=1))
        return found

    def _encloses(self, places: FloatArray) -> NDArray[np.bool_]:
        found = np.zeros(len(places), dtype=bool)
        for part in self.parts:
            found |= encloses(part, places)
        return found


def _along(triangles: FloatArray) -> tuple[FloatArray, NDArray[np.int_]]:
    """Places along each triangle, however thin it is, and the triangles' indices, (N, 3), (N,)."""
    lengths = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
    shortest = (lengths.argmin(axis=1)[:, None] + np.arange(3)) % 3
    p, q, tip = np.moveaxis(np.take_along_axis(triangles, shortest[:, :, None], axis=1), 1, 0)
    foot = (p + q) / 2
    count = np.ceil(np.linalg.norm(tip - foot, axis=1) / _SPACING).astype(int) + 1
    owners = np.repeat(np.arange(len(triangles)), count)
    number = np.arange(len(owners)) - np.repeat(np.cumsum(count) - count, count)
    share = ((number + 0.5) / count[owners])[:, None]
    return foot[owners] + share * (tip - foot)[owners], owners


def outward(part: FloatArray) -> float:
    """1 or -1 by which a closed surface's normals point out of it; 0 for others."""
    mesh = trimesh.Trimesh(part.reshape(-1, 3), np.arange(3 * len(part)).reshape(-1, 3))
    mesh.merge_vertices(digits_vertex=7)
    if not mesh.is_watertight or not mesh.is_winding_consistent:
        return 0.0
    return float(np.sign(mesh.volume))


def labels(triangles: FloatArray, group: NDArray[np.int_] | None = None) -> NDArray[np.int_]:
    """Which connected part each triangle belongs to, (T,); by groups, those of one share none."""
    corners = np.rint(triangles.reshape(-1, 3) / 1e-7)
    if group is not None:
        corners = np.column_stack([corners, np.repeat(group, 3)])
    _, vertex = np.unique(corners, axis=0, return_inverse=True)
    faces = vertex.reshape(-1, 3)
    count = int(faces.max(initial=-1)) + 1
    edges: NDArray[np.int_] = np.concatenate([faces[:, :2], faces[:, 1:]])
    ones = np.ones(len(edges))
    graph = coo_array((ones, (edges[:, 0], edges[:, 1])), shape=(count, count))
    found = np.asarray(connected_components(graph, directed=False)[1])
    return np.asarray(found[faces[:, 0]])
