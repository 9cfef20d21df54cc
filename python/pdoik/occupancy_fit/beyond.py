"""How far places are outside a link."""

from __future__ import annotations

import igl
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .hulls import FloatArray


class Beyond:
    """Distances from a link's solid: its parts, each with what it encloses."""

    def __init__(self, triangles: FloatArray) -> None:
        of = labels(triangles)
        self.parts = [triangles[of == label] for label in np.unique(of)]
        self._closed = [_mesh(part) for part in self.parts]
        self._surface = _mesh(triangles)
        self._tree = igl.AABB()
        self._tree.init(*self._surface)

    def __call__(self, places: FloatArray) -> FloatArray:
        """Of places (N, 3), 0 inside, (N,) [m]."""
        outside = np.arange(len(places))
        for corners, faces in self._closed:
            at = places[outside]
            near = ((at >= corners.min(axis=0)) & (at <= corners.max(axis=0))).all(axis=1)
            if near.any():
                # Whichever way its triangles are turned; a small hole does not matter.
                near[near] = np.abs(igl.fast_winding_number(corners, faces, at[near])) > 0.5
                outside = outside[~near]
        found = np.zeros(len(places))
        found[outside] = np.sqrt(self._tree.squared_distance(*self._surface, places[outside])[0])
        return found


def _mesh(triangles: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
    corners, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return corners, faces.reshape(-1, 3).astype(np.int64)


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
