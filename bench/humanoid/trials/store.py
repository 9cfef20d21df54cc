"""Results of an experiment in a folder: a JSON file per trial, written whole, read again."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from bench.common.whole_files import write_text
from bench.humanoid.dodge.plan import Plan
from bench.humanoid.world.throws import Throw
from pdoik.errors import LoadError

Record = dict[str, Any]
"""What one trial came to: plain JSON; metres, radians, seconds."""


class Store:
    """A folder with settings.json and results/NAME.json; what is there is not computed again.

    Args:
        folder: Made if it is not there.
        settings: What every result in it was made with.

    Raises:
        LoadError: The folder holds results of other settings, or a file that is no JSON.
    """

    def __init__(self, folder: Path, settings: Record) -> None:
        self.folder = folder
        (folder / "results").mkdir(parents=True, exist_ok=True)
        path = folder / "settings.json"
        wanted = plain(settings)
        if path.exists():
            found = _read(path)
            other = [key for key in wanted if found.get(key) != wanted[key]]
            if other:
                key = other[0]
                raise LoadError(
                    f"{folder} holds results with {key} = {found.get(key)!r}, not {wanted[key]!r}:"
                    " expected another folder or the same settings"
                )
        else:
            self._write(path, wanted)

    def get(self, name: str) -> Record | None:
        """A trial's record, None if it was not finished."""
        path = self._path(name)
        return _read(path) if path.exists() else None

    def put(self, name: str, record: Record) -> Record:
        """Keep a finished trial; what a later `get` gives."""
        content: Record = plain(record)
        self._write(self._path(name), content)
        return content

    def names(self) -> list[str]:
        """Names of all trials that are finished, in order."""
        return sorted(path.stem for path in (self.folder / "results").glob("[!.]*.json"))

    def _path(self, name: str) -> Path:
        return self.folder / "results" / f"{name}.json"

    @staticmethod
    def _write(path: Path, content: Record) -> None:
        write_text(path, json.dumps(content, indent=1, allow_nan=False) + "\n")


def _read(path: Path) -> Record:
    try:
        content = json.loads(path.read_text())
    except (UnicodeDecodeError, ValueError) as error:
        raise LoadError(f"{path}: not JSON, remove it to go on: {error}") from error
    if not isinstance(content, dict):
        raise LoadError(f"{path}: expected a JSON object, remove it to go on")
    return content


def plain(value: Any) -> Any:
    """Arrays and tuples as lists, what is not finite as None."""
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def throw_record(throw: Throw) -> Record:
    """A throw as `throw_of` reads it."""
    return {field.name: getattr(throw, field.name) for field in fields(Throw)}


def throw_of(record: Record) -> Throw:
    """The throw again."""
    values: Any = {key: tuple(v) if isinstance(v, list) else v for key, v in record.items()}
    return Throw(**values)


def plan_record(plan: Plan) -> Record:
    """A plan as `plan_of` reads it."""
    return {field.name: getattr(plan, field.name) for field in fields(Plan)}


def plan_of(record: Record) -> Plan:
    """The plan again."""
    values: Any = {key: np.array(v) if key.startswith("q_") else v for key, v in record.items()}
    return Plan(**values)
