"""Triangle meshes for coal."""

from typing import Any

import coal
import numpy as np
import numpy.typing as npt

from bench.common.arrays import FloatArray


def tree_of(vertices: FloatArray, faces: npt.NDArray[np.int64]) -> Any:
    """The bounding volumes by which coal looks at a mesh."""
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(faces), len(vertices))
    tree.addVertices(vertices)
    tree.addTriangles(faces)
    tree.endModel()
    return tree


def touch(a: Any, T_a: Any, b: Any, T_b: Any) -> bool:
    """Whether two of coal's shapes meet."""
    result = coal.CollisionResult()
    coal.collide(a, T_a, b, T_b, coal.CollisionRequest(), result)
    return bool(result.isCollision())


def is_inside(point: FloatArray, triangles: FloatArray) -> bool:
    """Whether a closed surface goes round a point: generalised winding number above one half."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    sine = np.einsum("ij,ij->i", a, np.cross(b, c))
    cosine = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return abs(float(np.arctan2(sine, cosine).sum())) / (2 * np.pi) > 0.5
