"""Vectors and poses as YAML and JSON files have them: as lists, or by component."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik.errors import LoadError

FloatArray = npt.NDArray[np.float64]


class EntryError(LoadError):
    """An entry of a file cannot be read: names the file, the entry, and what is wrong."""

    def __init__(self, file: Path, what: str, entry: str = "") -> None:
        super().__init__(f"{file}: {entry + ': ' if entry else ''}{what}")


def read_text(file: Path) -> str:
    """What is in a text file.

    Raises:
        EntryError: It is missing, a folder, or not UTF-8.
    """
    if not file.is_file():
        raise EntryError(file, "is a folder" if file.is_dir() else "no such file")
    try:
        return file.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise EntryError(file, f"cannot be read: {error}") from error


def read_yaml(file: Path) -> dict[str, Any]:
    """The mapping in a YAML file.

    Raises:
        EntryError: It is missing, or not a mapping in YAML.
    """
    import yaml

    text = read_text(file)
    try:
        content = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())[:200]
        raise EntryError(file, f"not YAML: {reason}") from error
    if not isinstance(content, dict):
        raise EntryError(file, f"expected a mapping, got {type(content).__name__}")
    return content


def numbers(value: Any, names: str, file: Path, entry: str) -> FloatArray:
    """As many finite numbers as `names` has letters: a list, or a mapping of these letters.

    Raises:
        EntryError: They are not.
    """
    if isinstance(value, Mapping):
        value = [value.get(name) for name in names]
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (len(names),) or not np.isfinite(array).all():
        raise EntryError(file, f"expected {len(names)} numbers {names}, got {value!r}", entry)
    return array


def rows(value: Any, names: str, file: Path, entry: str) -> FloatArray:
    """A list of such numbers, (N, len(names)).

    Raises:
        EntryError: Names the first that is none.
    """
    if not isinstance(value, list):
        raise EntryError(file, f"expected a list of numbers {names}, got {value!r}", entry)
    read = [numbers(row, names, file, f"{entry}[{k}]") for k, row in enumerate(value)]
    return np.array(read, dtype=np.float64).reshape(-1, len(names))


def rotation(xyzw: Any, file: Path, entry: str) -> FloatArray:
    """The matrix of a quaternion that need not be normalised."""
    from scipy.spatial.transform import Rotation

    quaternion = numbers(xyzw, "xyzw", file, entry)
    if np.linalg.norm(quaternion) < 1e-6:
        raise EntryError(file, "the quaternion is zero", entry)
    return np.asarray(Rotation.from_quat(quaternion).as_matrix())


def read_pose(value: Any, file: Path, entry: str) -> FloatArray:
    """A pose message, (4, 4): position and orientation, or translation and rotation.

    Either may be left out; an orientation of four zeros, which messages have by default, is none.
    """
    if value is None:
        return np.eye(4)
    if not isinstance(value, Mapping):
        raise EntryError(file, f"expected a pose, got {value!r}", entry)
    at = value.get("position", value.get("translation"))
    turn = value.get("orientation", value.get("rotation"))
    T = np.eye(4)
    if at is not None:
        T[:3, 3] = numbers(at, "xyz", file, f"{entry}.position")
    if turn is not None and np.any(numbers(turn, "xyzw", file, f"{entry}.orientation")):
        T[:3, :3] = rotation(turn, file, f"{entry}.orientation")
    return T
