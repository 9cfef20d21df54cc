"""Vectors and poses as YAML and JSON files have them: as lists, or by component."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from bench.problems.loaders.errors import LoaderError
from bench.problems.solids import pose
from scipy.spatial.transform import Rotation

FloatArray = npt.NDArray[np.float64]


def numbers(value: Any, names: str, file: Path, entry: str) -> FloatArray:
    """As many finite numbers as `names` has letters: a list, or a mapping of these letters.

    Raises:
        LoaderError: They are not.
    """
    if isinstance(value, Mapping):
        value = [value.get(name) for name in names]
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (len(names),) or not np.isfinite(array).all():
        raise LoaderError(file, f"expected {len(names)} numbers {names}, got {value!r}", entry)
    return array


def rotation(xyzw: Any, file: Path, entry: str) -> FloatArray:
    """The matrix of a quaternion that need not be normalised."""
    quaternion = numbers(xyzw, "xyzw", file, entry)
    if np.linalg.norm(quaternion) < 1e-6:
        raise LoaderError(file, "the quaternion is zero", entry)
    return np.asarray(Rotation.from_quat(quaternion).as_matrix())


def read_pose(value: Any, file: Path, entry: str) -> FloatArray:
    """A pose message, (4, 4): position and orientation, or translation and rotation.

    Either may be left out; an orientation of four zeros, which messages have by default, is none.
    """
    if value is None:
        return np.eye(4)
    if not isinstance(value, Mapping):
        raise LoaderError(file, f"expected a pose, got {value!r}", entry)
    at = value.get("position", value.get("translation"))
    turn = value.get("orientation", value.get("rotation"))
    T = np.eye(4)
    if at is not None:
        T[:3, 3] = numbers(at, "xyz", file, f"{entry}.position")
    if turn is not None and np.any(numbers(turn, "xyzw", file, f"{entry}.orientation")):
        T[:3, :3] = rotation(turn, file, f"{entry}.orientation")
    return T


__all__ = ["numbers", "pose", "read_pose", "rotation"]
