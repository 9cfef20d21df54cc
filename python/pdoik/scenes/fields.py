"""Distance fields of scenes: arrays in .npy and .npz files next to the scene's own."""

from __future__ import annotations

import math
import re
import zipfile
from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pdoik._addresses import Places
from pdoik._core import Shape
from pdoik._files import renamed_when_whole
from pdoik.errors import LoadError
from pdoik.scenes.values import EntryError, numbers

KEYS = ("cell", "truncation", "unknown")
"""What the scene or the .npz may say besides the values."""


def read_field(given: Mapping[str, Any], file: Path, entry: str, places: Places) -> dict[str, Any]:
    """What `Shape.distance_field` takes besides its name and pose, of {file, cell, ...}.

    The file is a .npy of the values, or an .npz of `values` and what else there is to say; what the
    scene says counts first.

    Raises:
        EntryError: There is no such file, it holds something else, or nobody says the cell.
    """
    try:
        path = places.find(str(given["file"]))
    except LoadError as error:
        raise EntryError(file, f"distance field {error}", entry) from error
    found = _loaded(path, file, entry)
    merged = {**found, **{key: given[key] for key in KEYS if given.get(key) is not None}}
    if "cell" not in merged:
        raise EntryError(file, f"neither the scene nor {path.name} says what cell is [m]", entry)
    result = {"values": found["values"], "unknown": str(merged.get("unknown", "free"))}
    for key in ("cell", "truncation"):
        value = merged.get(key)
        if value is not None:
            result[key] = _number(value, file, f"{entry}.{key}", math.inf if key != "cell" else 0.0)
    return result


def _number(value: Any, file: Path, entry: str, otherwise: float) -> float:
    if isinstance(value, float) and value == otherwise:
        return value
    return float(numbers([value], "m", file, entry)[0])


def _loaded(path: Path, file: Path, entry: str) -> dict[str, Any]:
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            return {"values": loaded}
        with loaded:
            found = {key: loaded[key] for key in ("values", *KEYS) if key in loaded}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise EntryError(file, f"cannot read {path}: {reason}", entry) from error
    if "values" not in found:
        raise EntryError(file, f"{path} holds no array called values", entry)
    for key in KEYS:
        if key in found and found[key].ndim != 0:
            raise EntryError(file, f"{key} of {path} is no single value", entry)
    return {key: each if key == "values" else each.item() for key, each in found.items()}


def write_field(shape: Shape, scene: Path, taken: Container[str]) -> str:
    """Write a shape's field next to a scene's file. Returns the name of the .npz.

    Args:
        shape: A distance field.
        scene: The file that is to name it.
        taken: Names that others have.
    """
    stem = f"{scene.stem}.{re.sub(r'[^A-Za-z0-9_-]', '_', shape.name)}"
    name, count = f"{stem}.npz", 1
    while name in taken:
        count += 1
        name = f"{stem}_{count}.npz"
    # Its values are known everywhere: none is to be found again.
    content = {"values": shape.values, "cell": shape.cell, "truncation": math.inf}
    with renamed_when_whole(scene.with_name(name)) as temporary, temporary.open("xb") as file:
        np.savez_compressed(file, **content)  # type: ignore[arg-type]
    return name
