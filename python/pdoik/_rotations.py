"""Rotations and their vectors: axis times angle."""

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def rotation_vector(R: FloatArray) -> FloatArray:
    """Axis times angle of a rotation, by its quaternion, (3,) [rad]."""
    K = np.array(
        [
            [R[0, 0] - R[1, 1] - R[2, 2], 0.0, 0.0, 0.0],
            [R[0, 1] + R[1, 0], R[1, 1] - R[0, 0] - R[2, 2], 0.0, 0.0],
            [R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], R[2, 2] - R[0, 0] - R[1, 1], 0.0],
            [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], np.trace(R)],
        ]
    )
    x, y, z, w = np.linalg.eigh(K, UPLO="L")[1][:, -1]
    v = np.array([x, y, z]) * (1.0 if w >= 0 else -1.0)
    sine = float(np.linalg.norm(v))
    return v * (2.0 if sine < 1e-12 else 2.0 * np.arctan2(sine, abs(w)) / sine)


def rotation_of(vector: FloatArray) -> FloatArray:
    """The rotation that a vector is of, (3, 3) (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    R: FloatArray = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    return R
