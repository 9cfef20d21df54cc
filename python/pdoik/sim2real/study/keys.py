"""The text of a study: its keys and the types of their values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import yaml

from pdoik.errors import LoadError
from pdoik.recordings import MAX_ROWS, ColumnsKey, FloatArray, Part, Role, columns_key, entry_keys

from .key_tables import ENTRY, SETUP, STUDY, TRUST
from .study import Trust
from .values import checked as checked
from .values import names as names
from .values import number as number
from .values import shown
from .values import text as text
from .values import vector as vector

_MORE_THAN_NOTHING = float(np.nextafter(0.0, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A recording's file as the study names it."""

    name: str  # the file's, with folders as the study has them where two are called alike
    path: Path
    role: Role = "fit"
    part: Part
    columns: ColumnsKey | None = None  # where its names are others than the study's files have
    reading: Mapping[str, Any] = field(default_factory=dict)  # what only its kind of log has
    told: Mapping[str, Any] = field(default_factory=dict)  # what it says of `SETUP`


def read_keys(path: Path) -> dict[str, Any]:
    """The study's mapping, its keys checked.

    Raises:
        LoadError: no such file, no YAML, or an unknown or missing key.
    """
    mapping = read_part(path)
    if not mapping.get("recordings"):
        raise LoadError(f"{path.name}: expected 'recordings:' with at least one file")
    return mapping


def read_part(path: Path) -> dict[str, Any]:
    """The mapping of a study that may still lack its recordings, its keys checked."""
    try:
        content = yaml.safe_load(path.read_text())
    except OSError as error:
        raise LoadError(f"study: cannot read {path}: {error.strerror}") from error
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise LoadError(f"{path.name}: no YAML: {error}") from error
    for key in content if isinstance(content, dict) else ():
        if key not in STUDY and key in (*ENTRY, *entry_keys(), *SETUP):
            raise LoadError(
                f"{path.name}: {key!r} is a key of an entry of 'recordings:', not of the study"
            )
    return checked(content, STUDY, path.name)


def entries(content: Any, folder: Path, source: str, max_rows: Any = None) -> tuple[Entry, ...]:
    """The files of a list of recordings: names, or mappings with `file`."""
    if not isinstance(content, list):
        raise LoadError(f"{source}: expected a list of files, got {shown(content)}")
    rows = MAX_ROWS if max_rows is None else int(number(max_rows, "max_rows", least=1))
    found = [_entry(each, folder, f"{source}[{k}]", rows) for k, each in enumerate(content)]
    files = [each.name for each in found]
    twice = [file for file in files if files.count(file) > 1]
    if twice:
        raise LoadError(f"{source}: {twice[0]} is listed more than once")
    short = [Path(file).name for file in files]
    return tuple(
        replace(each, name=name) if short.count(name) == 1 else each
        for each, name in zip(found, short, strict=True)
    )


def _entry(content: Any, folder: Path, source: str, max_rows: int) -> Entry:
    if isinstance(content, str):
        content = {"file": content}
    mapping = checked(content, (*ENTRY, *entry_keys(), *SETUP), source)
    file = text(mapping.get("file"), f"{source}: file")
    if file is None:
        raise LoadError(f"{source}: expected 'file:'")
    role = mapping.get("role", "fit")
    if role not in ("fit", "validate"):
        raise LoadError(f"{source} ({file}): role: expected fit or validate, got {role!r}")
    window = mapping.get("window")
    if window is not None:
        ends = vector(window, f"{source} ({file}): window", 2)
        if not ends[0] < ends[1]:
            raise LoadError(f"{source} ({file}): window: expected [from, to] [s], got {window!r}")
        window = (float(ends[0]), float(ends[1]))
    every = number(mapping.get("every", 1), f"{source} ({file}): every", least=1)
    own = mapping.get("columns")
    return Entry(
        name=file,
        path=folder / Path(file).expanduser(),
        role=cast(Role, role),
        part=Part(every=int(every), window=window, max_rows=max_rows),
        columns=None if own is None else columns_key(own, f"{source} ({file}): columns"),
        reading=_reading(mapping, f"{source} ({file})"),
        told={key: mapping[key] for key in SETUP if mapping.get(key) is not None},
    )


def _reading(mapping: Mapping[str, Any], source: str) -> dict[str, Any]:
    """What an entry says of how to read its log."""
    found = {key: mapping[key] for key in entry_keys() if mapping.get(key) is not None}
    if mapping.get("rate") is not None:
        found["rate"] = number(mapping["rate"], f"{source}: rate", least=_MORE_THAN_NOTHING)
    return found


def trust_from(content: Any) -> Trust:
    """The study's `trust`."""
    if content is None:
        return Trust()
    keys = checked(content, TRUST, "trust")
    shares = {
        key: number(value, f"trust: {key}", least=0.0)
        for key, value in keys.items()
        if value is not None
    }
    return Trust(**shares)


def per_joint(
    content: Any, source: str, joints: tuple[str, ...], positive: bool = False
) -> FloatArray:
    """A number for each joint, from a list or a mapping by name, (n,), none negative."""
    if isinstance(content, dict):
        checked(content, joints, source)
        missing = [joint for joint in joints if joint not in content]
        if missing:
            raise LoadError(f"{source}: nothing for joint {missing[0]!r}")
        content = [content[joint] for joint in joints]
    values = vector(content, source, len(joints), "joints")
    if (values < 0).any() or (positive and (values == 0).any()):
        k = int(np.argmin(values))
        raise LoadError(
            f"{source}: expected {'positive numbers' if positive else 'none negative'}, got"
            f" {values[k]:g} for {joints[k]}"
        )
    return values
