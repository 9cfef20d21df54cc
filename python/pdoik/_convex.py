"""Convex hulls, for solids that are given by their corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pdoik._extras import asks_for


@asks_for("files")
def hull(
    vertices: NDArray[np.float64], name: str
) -> tuple[NDArray[np.float64], list[tuple[int, int, int]]]:
    """The corners of the points' convex hull and its triangles, counter-clockwise from outside.

    Args:
        vertices: Shape (N, 3).
        name: Whose they are, for the complaint.

    Raises:
        ValueError: They are no points in space, or lie in one plane.
    """
    from scipy.spatial import ConvexHull, QhullError

    if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
        raise ValueError(f"shape '{name}': vertices are not finite and of shape (N, 3)")
    try:
        found = ConvexHull(vertices)
    except (QhullError, ValueError):
        raise ValueError(f"shape '{name}': the vertices lie in one plane") from None
    corners = {int(vertex): place for place, vertex in enumerate(found.vertices)}
    triangles = []
    for triangle, equation in zip(found.simplices, found.equations, strict=True):
        a, b, c = vertices[triangle]
        i, j, k = (corners[int(vertex)] for vertex in triangle)
        outward = np.cross(b - a, c - a) @ equation[:3] > 0
        triangles.append((i, j, k) if outward else (i, k, j))
    return np.ascontiguousarray(vertices[found.vertices]), triangles
