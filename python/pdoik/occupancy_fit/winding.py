"""Whether points are inside closed surfaces, by the solid angle that these take of the view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .hulls import FloatArray

_CHUNK = 400_000  # of points by triangles, at a time


def encloses(triangles: FloatArray, points: FloatArray) -> NDArray[np.bool_]:
    """Which points (N, 3) a surface (T, 3, 3) encloses, whichever way its triangles are turned.

    By the winding number (van Oosterom and Strackee, 1983): a small hole does not matter.
    """
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    near = ((points >= low) & (points <= high)).all(axis=1)
    inside = np.zeros(len(points), dtype=bool)
    step = max(_CHUNK // max(len(triangles), 1), 1)
    index = np.flatnonzero(near)
    for n in range(0, len(index), step):
        part = index[n : n + step]
        inside[part] = np.abs(_winding(triangles, points[part])) > 0.5
    return inside


def _winding(triangles: FloatArray, points: FloatArray) -> FloatArray:
    to = triangles[None] - points[:, None, None]  # (N, T, 3, 3)
    lengths = np.linalg.norm(to, axis=3)
    a, b, c = np.moveaxis(to, 2, 0)
    la, lb, lc = np.moveaxis(lengths, 2, 0)
    numerator = np.einsum("nti,nti->nt", a, np.cross(b, c))
    denominator = (
        la * lb * lc
        + np.einsum("nti,nti->nt", a, b) * lc
        + np.einsum("nti,nti->nt", b, c) * la
        + np.einsum("nti,nti->nt", c, a) * lb
    )
    return np.asarray(np.arctan2(numerator, denominator).sum(axis=1) / (2 * np.pi))
