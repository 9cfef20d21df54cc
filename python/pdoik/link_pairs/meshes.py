"""Whether two triangle meshes meet."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
_PAIRS_AT_ONCE = 1 << 20
_EDGES = ((0, 1), (1, 2), (2, 0))


class Mesh:
    """Triangles, (T, 3, 3) [m], with what shows that they are far away."""

    def __init__(self, triangles: FloatArray) -> None:
        self.triangles = triangles
        self.low, self.high = triangles.min(axis=1), triangles.max(axis=1)
        corners = triangles.reshape(-1, 3)
        self.center = (corners.min(axis=0) + corners.max(axis=0)) / 2
        self.radius = float(np.linalg.norm(corners - self.center, axis=1).max())


def meet(one: Mesh, other: Mesh, T_one_other: FloatArray) -> bool:
    """Whether any two triangles have a point in common; a mesh all within another meets it not.

    Args:
        one: In its own frame.
        other: In its own frame.
        T_one_other: The other's pose in the first one's frame, (4, 4).
    """
    R, t = T_one_other[:3, :3], T_one_other[:3, 3]
    if np.linalg.norm(R @ other.center + t - one.center) > one.radius + other.radius:
        return False
    mine, theirs = one.triangles, other.triangles @ R.T + t
    low, high = theirs.min(axis=1), theirs.max(axis=1)
    for _ in range(2):  # only what lies in the other's box, twice: the boxes shrink
        if not (len(mine) and len(theirs)):
            return False
        near = _in_box(mine.min(axis=1), mine.max(axis=1), low.min(axis=0), high.max(axis=0))
        mine = mine[near]
        if not len(mine):
            return False
        corners = mine.reshape(-1, 3)
        near = _in_box(low, high, corners.min(axis=0), corners.max(axis=0))
        theirs, low, high = theirs[near], low[near], high[near]
    if not len(theirs):
        return False
    rows = max(1, _PAIRS_AT_ONCE // len(theirs))
    return any(_any_meet(mine[k : k + rows], theirs, low, high) for k in range(0, len(mine), rows))


def _in_box(
    low: FloatArray, high: FloatArray, box_low: FloatArray, box_high: FloatArray
) -> npt.NDArray[np.bool_]:
    inside: npt.NDArray[np.bool_] = np.all((high >= box_low) & (low <= box_high), axis=-1)
    return inside


def _any_meet(mine: FloatArray, theirs: FloatArray, low: FloatArray, high: FloatArray) -> bool:
    boxes_meet = np.ones((len(mine), len(theirs)), dtype=bool)
    my_low, my_high = mine.min(axis=1), mine.max(axis=1)
    for axis in range(3):
        boxes_meet &= my_high[:, None, axis] >= low[None, :, axis]
        boxes_meet &= my_low[:, None, axis] <= high[None, :, axis]
    i, j = boxes_meet.nonzero()
    return any(
        _crosses(edges_of[:, a], edges_of[:, b], faces).any()
        for edges_of, faces in ((mine[i], theirs[j]), (theirs[j], mine[i]))
        for a, b in _EDGES
    )


def _crosses(start: FloatArray, end: FloatArray, faces: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether each segment crosses its triangle (Moller and Trumbore 1997); not if parallel."""
    along = end - start
    side_1, side_2 = faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
    normal = np.cross(along, side_2)
    determinant = np.einsum("ij,ij->i", side_1, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / determinant
        gap = start - faces[:, 0]
        u = inverse * np.einsum("ij,ij->i", gap, normal)
        across = np.cross(gap, side_1)
        v = inverse * np.einsum("ij,ij->i", along, across)
        t = inverse * np.einsum("ij,ij->i", side_2, across)
        hit: npt.NDArray[np.bool_] = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)
    return hit
