"""Surfaces of shapes inside of what a picture shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from trimesh.intersections import slice_faces_plane

import pdoik
from pdoik.solids import shape_mesh

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cube:
    """What a picture shows: all within a distance of a place along each axis.

    Attributes:
        center: (3,) [m].
        reach: Half its edge [m].
    """

    center: FloatArray
    reach: float

    def holds(self, points: FloatArray) -> npt.NDArray[np.bool_]:
        """Which of them are in it, (N,)."""
        return np.asarray(np.abs(points - self.center).max(axis=1, initial=0) <= self.reach)


def shape_triangles(shape: pdoik.Shape, cube: Cube) -> FloatArray:
    """Surface of a shape inside a cube, (T, 3, 3) in the base frame [m]."""
    plane_edge = 4.0 * (float(np.linalg.norm(cube.center)) + cube.reach)
    mesh, T = shape_mesh(shape, plane_edge)
    vertices = np.asarray(mesh.vertices) @ T[:3, :3].T + T[:3, 3]
    faces = np.asarray(mesh.faces)
    for axis in range(3):
        for side in (-1.0, 1.0):
            beyond = side * (vertices[:, axis] - cube.center[axis]) > cube.reach
            if beyond.all():
                return np.empty((0, 3, 3))
            if not beyond.any():
                continue
            inward = np.zeros(3)
            inward[axis] = -side
            on = cube.center - cube.reach * inward
            cut = slice_faces_plane(  # type: ignore[no-untyped-call]
                vertices, faces, inward, on
            )
            vertices, faces = np.asarray(cut[0]), np.asarray(cut[1], dtype=np.int64)
            if not len(faces):
                return np.empty((0, 3, 3))
    return np.asarray(vertices[faces])


def in_pieces(triangles: FloatArray, piece: float) -> FloatArray:
    """The same surface in triangles of which no edge is longer than a piece, (N, 3, 3) [m]."""
    done = []
    while len(triangles):
        edges = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)  # (T, 3)
        longest = edges.argmax(axis=1)
        long = edges.max(axis=1) > piece
        done.append(triangles[~long])
        halved, k = triangles[long], longest[long]
        row = np.arange(len(halved))
        a, b, c = (halved[row, (k + i) % 3] for i in range(3))
        middle = (a + b) / 2
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
    return np.concatenate([*done, np.empty((0, 3, 3))])
