"""Names of arrays in signatures."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def moved(points: FloatArray, T: FloatArray) -> FloatArray:
    """Points (..., 3) where a transform (4, 4) takes them."""
    return np.asarray(points @ T[:3, :3].T + T[:3, 3])


def z_along(axis: FloatArray) -> FloatArray:
    """A rotation whose z is a unit axis, (3, 3)."""
    x = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])
