"""Targets as words on the command line, or as files with a 4x4 matrix."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .messages import warn_of_degrees

FloatArray = npt.NDArray[np.float64]

FORMS = (
    '"x y z qx qy qz qw", "x y z roll pitch yaw", "x y z" for position goals,'
    " or a .npy, .json or .txt file with a 4x4 matrix"
)
_LOOSE = 1e-3  # how far numbers typed with few digits may be from a rotation


def parse_target(text: str, goal: str, option: str = "--target") -> FloatArray:
    """A pose (4, 4) [m] from one of `FORMS`; what was rounded is made rigid again.

    Args:
        text: As it was given.
        goal: "position" may leave out the orientation.
        option: Who gave it, for a warning of degrees.

    Raises:
        ValueError: It is none of them, is not finite, or is no rigid motion.
    """
    if Path(text).suffix.lower() in {".npy", ".json", ".txt"}:
        return rigid(_read_matrix(Path(text)), text)
    try:
        numbers = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError:
        raise ValueError(f"expected {FORMS}; got {text!r}") from None
    if not np.isfinite(numbers).all():
        raise ValueError(f"expected finite numbers, got {text!r}")
    T = np.eye(4)
    if len(numbers) == 7:
        T[:3, :3] = rotation_of_xyzw(numbers[3:])
    elif len(numbers) == 6:
        warn_of_degrees(option, numbers[3:])
        T[:3, :3] = rotation_of_rpy(*numbers[3:])
    elif len(numbers) == 3 and goal != "position":
        raise ValueError(
            f"x y z alone has no orientation, which --goal {goal} needs:"
            " give 6 or 7 numbers, or --goal position"
        )
    elif len(numbers) != 3:
        raise ValueError(f"expected {FORMS}; got {len(numbers)} numbers")
    T[:3, 3] = numbers[:3]
    return T


def rotation_of_xyzw(xyzw: FloatArray, order: str = "qx qy qz qw") -> FloatArray:
    """The rotation of a quaternion with its real part last, normalised.

    Args:
        xyzw: The quaternion, (4,).
        order: In which it was given, for the error.

    Raises:
        ValueError: Its norm is not 1 to 1e-3.
    """
    norm = float(np.linalg.norm(xyzw))
    if abs(norm - 1) > _LOOSE:
        raise ValueError(f"expected a quaternion {order} of norm 1, got norm {norm:.4g}")
    x, y, z, w = xyzw / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_of_rpy(roll: float, pitch: float, yaw: float) -> FloatArray:
    """Rz(yaw) Ry(pitch) Rx(roll) [rad], the convention of URDF."""
    cr, sr = np.cos(roll), np.sin(roll)
    cp, sp = np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _read_matrix(path: Path) -> FloatArray:
    if not path.is_file():
        raise ValueError(f"{path}: no such file")
    try:
        if path.suffix.lower() == ".npy":
            matrix = np.load(path, allow_pickle=False)
        elif path.suffix.lower() == ".json":
            matrix = np.array(json.loads(path.read_text(encoding="utf-8")), dtype=np.float64)
        else:
            matrix = np.loadtxt(path.read_text(encoding="utf-8").replace(",", " ").splitlines())
        return np.asarray(matrix, dtype=np.float64)
    except (ValueError, TypeError, EOFError) as error:
        raise ValueError(f"{path}: expected a 4x4 matrix: {error}") from error


def rigid(matrix: FloatArray, name: str) -> FloatArray:
    """A (4, 4) matrix whose rotation was rounded, made rigid again.

    Raises:
        ValueError: It is none, by more than rounding; names it.
    """
    if matrix.shape != (4, 4):
        raise ValueError(f"{name}: expected a 4x4 matrix, got shape {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise ValueError(f"{name}: expected finite numbers, got NaN or infinity")
    if np.abs(matrix[3] - [0, 0, 0, 1]).max() > 1e-9:
        raise ValueError(f"{name}: expected the last row 0 0 0 1, got {matrix[3].tolist()}")
    U, _, Vt = np.linalg.svd(matrix[:3, :3])
    nearest = U @ Vt
    off = float(np.abs(nearest - matrix[:3, :3]).max())
    if off > _LOOSE or np.linalg.det(nearest) < 0:
        raise ValueError(
            f"{name}: expected a rotation in the upper left 3x3, got a matrix of determinant"
            f" {np.linalg.det(matrix[:3, :3]):.4g}, {off:.2g} from the nearest orthogonal one"
        )
    T = matrix.copy()
    T[:3, :3] = nearest
    return T
