"""Fields of signed distances in NumPy: values between their cells, and the surface they enclose."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]

_CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def distances_at(values: Values, cell: float, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What a field says of points in its frame.

    Outside the box of the cells' middles: of the nearest place in it, with what the point is off.

    Args:
        values: Of the cells' middles, (X, Y, Z) [m].
        cell: A cell's edge [m].
        points: (N, 3) [m].

    Returns:
        Signed distances, (N,) [m], and their gradients, (N, 3).
    """
    places = points / cell - 0.5
    last = np.array(values.shape) - 1
    inside = np.clip(places, 0, last)
    first = np.minimum(inside.astype(np.int64), last - 1)
    within = inside - first
    corners = first[:, None] + _CORNERS
    at_corners = values[corners[..., 0], corners[..., 1], corners[..., 2]].astype(np.float64)
    shares = np.where(_CORNERS == 1, within[:, None], 1 - within[:, None])  # (N, 8, 3)
    signs = np.where(_CORNERS == 1, 1.0, -1.0)
    found = (shares.prod(axis=2) * at_corners).sum(axis=1)
    gradient = np.empty_like(points)
    for a in range(3):
        others = shares[..., [b for b in range(3) if b != a]].prod(axis=2)
        gradient[:, a] = (signs[:, a] * others * at_corners).sum(axis=1) / cell
    off = cell * (places - inside)
    length = np.linalg.norm(off, axis=1)
    gradient[off != 0] = 0.0
    distances = np.where(found > 0, np.hypot(found, length), found + length)
    with np.errstate(divide="ignore", invalid="ignore"):
        outer = np.where(
            found[:, None] > 0,
            (found[:, None] * gradient + off) / distances[:, None],
            gradient + off / length[:, None],
        )
    return distances, np.where(length[:, None] > 0, outer, gradient)


def least_along(values: Values, cell: float, a: FloatArray, b: FloatArray) -> float:
    """The least signed distance of the points of a segment from a to b in the field's frame [m]."""
    last = np.array(values.shape) - 1
    start, way = a / cell - 0.5, (b - a) / cell
    cuts = [np.array([0.0, 1.0])]
    for n, from_place, along in zip(last, start, way, strict=True):
        if along != 0:
            crossed = (np.arange(n + 1) - from_place) / along
            cuts.append(crossed[(crossed > 0) & (crossed < 1)])
    t = np.unique(np.concatenate(cuts))

    def at(share: FloatArray) -> FloatArray:
        """Distances at places in each interval, (K,), by interval (T, K)."""
        places = t[:-1, None] + np.diff(t)[:, None] * share
        points = a + places.reshape(-1, 1) * (b - a)
        return distances_at(values, cell, points)[0].reshape(places.shape)

    # In a cell it is a cubic: by four of its values, where its slope is 0. Outside the box it is
    # something like that, and looked at more closely.
    of_cubic = np.linalg.inv(np.vander(np.linspace(0, 1, 4), 4))
    coefficients = at(np.linspace(0, 1, 4)) @ of_cubic.T
    A, B, C = (n * coefficients[:, k] for k, n in enumerate((3.0, 2.0, 1.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(B * B - 4 * A * C, 0))
        q = -0.5 * (B + np.copysign(root, B))
        turns = np.clip(np.nan_to_num(np.stack([q / A, C / q], axis=1)), 0, 1)
    lengths = np.diff(t)[:, None]
    points = a + (t[:-1, None] + lengths * turns).reshape(-1, 1) * (b - a)
    least = min(
        float(distances_at(values, cell, points)[0].min()), float(at(np.linspace(0, 1, 4)).min())
    )
    middles = start + 0.5 * (t[:-1] + t[1:])[:, None] * way
    if ((middles < 0) | (middles > last)).any():
        least = min(least, float(at(np.linspace(0, 1, 65)).min()))
    return least


def zero_level(values: Values, cell: float) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """The surface where a field is 0: vertices (V, 3) [m], in its frame, and triangles (F, 3).

    Of each eight neighbours of both signs a vertex, in the middle of where the field changes sign
    along the edges between them; of each such edge a square of the four around it (Gibson,
    "Constrained elastic surface nets", 1998). What reaches the border of the grid is open there.
    """
    low = values < 0
    cubes = np.array(values.shape) - 1
    count = sum(
        low[i : cubes[0] + i, j : cubes[1] + j, k : cubes[2] + k].astype(np.int8)
        for i, j, k in _CORNERS
    )
    crossed = np.argwhere((count > 0) & (count < 8))  # (V, 3)
    number = np.full(tuple(cubes), -1, dtype=np.int64)
    number[tuple(crossed.T)] = np.arange(len(crossed))
    places, crossings = np.zeros((len(crossed), 3)), np.zeros(len(crossed))
    for axis in range(3):
        for corner in _CORNERS[_CORNERS[:, axis] == 0]:
            one, other = crossed + corner, crossed + corner + np.eye(3, dtype=int)[axis]
            v, w = (values[tuple(each.T)].astype(np.float64) for each in (one, other))
            changes = (v < 0) != (w < 0)
            share = v / np.where(changes, v - w, 1.0)
            places += np.where(changes[:, None], one + share[:, None] * (other - one), 0.0)
            crossings += changes
    vertices = cell * (places / crossings[:, None] + 0.5) if len(crossed) else places
    squares = []
    for axis in range(3):
        u, v = (np.eye(3, dtype=int)[(axis + n) % 3] for n in (1, 2))
        ahead = np.diff(low.astype(np.int8), axis=axis)
        edges = np.argwhere(ahead != 0)
        inner = ((edges[:, [(axis + 1) % 3, (axis + 2) % 3]] > 0).all(axis=1)) & (
            (edges < cubes).all(axis=1)
        )
        edges = edges[inner]
        around = np.stack([edges - u - v, edges - v, edges, edges - u], axis=1)  # (E, 4, 3)
        corners = number[around[..., 0], around[..., 1], around[..., 2]]
        leaves = ahead[tuple(edges.T)] < 0  # out of what is solid along the axis
        squares.append(np.where(leaves[:, None], corners, corners[:, ::-1]))
    square = np.concatenate(squares)
    return vertices, np.concatenate([square[:, [0, 1, 2]], square[:, [0, 2, 3]]])
