"""Faces of many corners as triangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pdoik._extras import asks_for

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@asks_for("files")
def triangulated(vertices: FloatArray, corners: IntArray, counts: IntArray) -> IntArray:
    """Triangles that turn as their faces do, (T, 3) places in `vertices`.

    Every edge of a face is an edge of one of its triangles, so that what is closed stays closed. A
    face of n corners gives n - 2 triangles; one of fewer than three gives none.

    Args:
        vertices: Shape (V, 3).
        corners: Of all faces one after the other, places in `vertices`.
        counts: The corners of each face, (F,), at least 0.
    """
    with np.errstate(invalid="ignore", over="ignore"):  # of corners that are not finite
        return _triangulated(vertices, corners, counts)


def _triangulated(vertices: FloatArray, corners: IntArray, counts: IntArray) -> IntArray:
    starts = np.cumsum(counts) - counts
    found = []
    for count in np.unique(counts[counts >= 3]).tolist():
        faces = corners[starts[counts == count, None] + np.arange(count)]  # (F, count)
        fans = np.stack(
            [np.broadcast_to(faces[:, :1], (len(faces), count - 2)), faces[:, 1:-1], faces[:, 2:]],
            axis=-1,
        )  # (F, count - 2, 3)
        whole = np.ones(len(faces), dtype=bool) if count == 3 else _is_whole(vertices, faces, fans)
        found.append(fans[whole].reshape(-1, 3))
        found += [_cut(vertices, face) for face in faces[~whole]]
    return np.concatenate([np.empty((0, 3), dtype=np.int64), *found])


def _is_whole(vertices: FloatArray, faces: IntArray, fans: IntArray) -> npt.NDArray[np.bool_]:
    """Whether the triangles about each face's first corner all turn as the face does, (F,)."""
    a, b, c = (vertices[fans[..., k]] for k in range(3))
    areas = np.cross(b - a, c - a)  # (F, count - 2, 3)
    turns = np.einsum("fti,fi->ft", areas, areas.sum(axis=1))
    return np.asarray((turns >= 0).all(axis=1))


def _cut(vertices: FloatArray, face: IntArray) -> IntArray:
    """A face that is not convex, seen along its normal and cut at its ears."""
    from mapbox_earcut import triangulate_float64

    fan = np.array([[0, k, k + 1] for k in range(1, len(face) - 1)])
    points = vertices[face] - vertices[face[0]]
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    if not (np.isfinite(normal).all() and np.isfinite(points).all() and normal.any()):
        return np.asarray(face[fan])  # no area, or none that is known
    across = np.linalg.svd(normal[None])[2][1:]  # (2, 3), a basis of the plane
    if np.linalg.det(np.vstack([across, normal / np.abs(normal).max()])) < 0:
        across = across[::-1]
    flat = np.ascontiguousarray(points @ across.T)
    ends = np.array([len(face)], dtype=np.uint32)
    cut = triangulate_float64(flat, ends).reshape(-1, 3).astype(np.int64)
    if len(cut) != len(face) - 2:  # it crosses itself
        cut = fan
    a, b, c = (flat[cut[:, k]] for k in range(3))
    (u, v), (s, t) = (b - a).T, (c - a).T
    backward = u * t - v * s < 0
    return np.asarray(face[np.where(backward[:, None], cut[:, ::-1], cut)])
