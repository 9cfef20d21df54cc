"""How far places are outside a link."""

from __future__ import annotations

import igl
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .hulls import FloatArray

_CELL = 4e-3  # edge of the cells that are inside, outside or crossed as a whole [m]
_MOST_CELLS = 1_000_000  # of a part; of a large one they are larger
_BATCH = 200  # of the farthest places, whose sides are asked for at a time


class Beyond:
    """Distances from a link's solid: its parts, each with what it encloses."""

    def __init__(self, triangles: FloatArray) -> None:
        of = labels(triangles)
        self.parts = [triangles[of == label] for label in np.unique(of)]
        self._enclosed = [_Enclosed(part) for part in self.parts]
        self._surface = _Surface(triangles)

    def __call__(self, places: FloatArray, more_than: float = 0.0) -> FloatArray:
        """Distances of places (N, 3), 0 inside and where not more than asked for, (N,) [m]."""
        found = self._unless_deep(places)
        far = np.flatnonzero(found > more_than)
        inside = self._inside(places[far])
        found[found <= more_than] = 0.0
        found[far[inside]] = 0.0
        return found

    def most(self, places: FloatArray) -> float:
        """The largest of the distances [m]."""
        found = self._unless_deep(places)
        order = np.argsort(-found, kind="stable")
        for n in range(0, len(order), _BATCH):
            at = order[n : n + _BATCH]
            out = at[~self._inside(places[at])]
            if len(out):
                return float(found[out[0]])
        return 0.0

    def _unless_deep(self, places: FloatArray) -> FloatArray:
        """Distances from the surface, 0 where cells show that it is inside, (N,) [m]."""
        found = np.zeros(len(places))
        rest = np.arange(len(places))
        for part in self._enclosed:
            rest = rest[part.sides(places[rest]) != _INSIDE]
        found[rest] = self._surface.distance(places[rest])
        return found

    def _inside(self, places: FloatArray) -> NDArray[np.bool_]:
        found = np.zeros(len(places), dtype=bool)
        for part in self._enclosed:
            rest = np.flatnonzero(~found)
            found[rest] = part.holds(places[rest])
        return found


class _Surface:
    """Distances from triangles, by a tree of them."""

    def __init__(self, triangles: FloatArray) -> None:
        corners, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        self.corners, self.faces = corners, faces.reshape(-1, 3).astype(np.int64)
        self._tree = igl.AABB()
        self._tree.init(self.corners, self.faces)

    def distance(self, places: FloatArray) -> FloatArray:
        """Distances of places (N, 3), (N,) [m]."""
        if not len(places):
            return np.zeros(0)
        return np.asarray(np.sqrt(self._tree.squared_distance(self.corners, self.faces, places)[0]))


_UNKNOWN, _CROSSED, _INSIDE, _OUTSIDE = range(4)


class _Enclosed:
    """What a connected part encloses, whichever way its triangles are turned.

    By winding numbers: a small hole does not matter. They are the same all over a cell that the
    surface does not come near, and known of each cell that was once asked for.
    """

    def __init__(self, part: FloatArray) -> None:
        self._surface = _Surface(part)
        corners = self._surface.corners
        self._winding = igl.FastWindingNumberBVH()
        self._winding.init(corners, self._surface.faces)
        self._low, self._high = corners.min(axis=0), corners.max(axis=0)
        size = self._high - self._low
        self._cell = max(_CELL, float(np.cbrt(np.prod(size + _CELL) / _MOST_CELLS)))
        self._shape = np.floor(size / self._cell).astype(np.int64) + 1
        self._side = np.full(int(np.prod(self._shape)), _UNKNOWN, dtype=np.int8)

    def sides(self, places: FloatArray) -> NDArray[np.int8]:
        """Where places (N, 3) are by their cells, (N,)."""
        found = np.full(len(places), _OUTSIDE, dtype=np.int8)
        near = np.flatnonzero(((places >= self._low) & (places <= self._high)).all(axis=1))
        cells = ((places[near] - self._low) / self._cell).astype(np.int64)
        index = np.ravel_multi_index(tuple(cells.T), tuple(self._shape))
        asked = np.unique(index[self._side[index] == _UNKNOWN])
        if len(asked):
            cells = np.stack(np.unravel_index(asked, tuple(self._shape)), axis=1)
            centers = self._low + self._cell * (cells + 0.5)
            crossed = self._surface.distance(centers) < np.sqrt(3) / 2 * self._cell + 1e-9
            self._side[asked] = np.where(crossed, _CROSSED, _OUTSIDE)
            clear = asked[~crossed]
            self._side[clear[self._wound(centers[~crossed])]] = _INSIDE
        found[near] = self._side[index]
        return found

    def holds(self, places: FloatArray) -> NDArray[np.bool_]:
        """Which places (N, 3) it encloses, (N,)."""
        sides = self.sides(places)
        found = sides == _INSIDE
        crossed = sides == _CROSSED
        found[crossed] = self._wound(places[crossed])
        return np.asarray(found)

    def _wound(self, places: FloatArray) -> NDArray[np.bool_]:
        if not len(places):
            return np.zeros(0, dtype=bool)
        return np.asarray(np.abs(self._winding.winding_number(places)) > 0.5)


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
