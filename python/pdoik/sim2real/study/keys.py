"""The text of a study: its keys and the types of their values."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import yaml

from pdoik.errors import LoadError

from .columns import nearest
from .read_table import MAX_ROWS, Part
from .recording import FloatArray, Role
from .study import Trust

KEYS = (
    "robot",
    "tip",
    "joints",
    "recordings",
    "controller",
    "simulation",
    "simulator",
    "trust",
    "rotor_inertia",
    "units",
    "ignore",
    "max_rows",
)
"""What a study may say. The last three: units of columns, columns to pass over, rows per file."""

_ENTRY = ("file", "role", "topic", "command_topic", "window", "every")
TOLD = ("robot", "payload", "compensated", "controller", "session", "temperature", "surface")
"""What a recording's entry may say of how it was made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A recording's file as the study names it."""

    name: str  # the file's, with folders as the study has them where two are called alike
    path: Path
    role: Role = "fit"
    topic: str | None = None  # of a bag
    command_topic: str | None = None
    part: Part
    told: Mapping[str, Any] = field(default_factory=dict)  # what it says of `TOLD`


def read_keys(path: Path) -> dict[str, Any]:
    """The study's mapping, its keys checked.

    Raises:
        LoadError: no such file, no YAML, or an unknown or missing key.
    """
    try:
        content = yaml.safe_load(path.read_text())
    except OSError as error:
        raise LoadError(f"study: cannot read {path}: {error.strerror}") from error
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise LoadError(f"{path.name}: no YAML: {error}") from error
    mapping = checked(content, KEYS, path.name)
    if not mapping.get("recordings"):
        raise LoadError(f"{path.name}: expected 'recordings:' with at least one file")
    return mapping


def checked(content: Any, keys: Collection[str], source: str) -> dict[str, Any]:
    """`content` as a mapping that has these keys only."""
    if not isinstance(content, dict):
        raise LoadError(f"{source}: expected 'key: value' lines, got {_shown(content)}")
    for key in content:
        if key not in keys:
            known = nearest(str(key), keys) or f"; expected one of {', '.join(keys)}"
            raise LoadError(f"{source}: unknown key {key!r}{known}")
    return content


def entries(content: Any, folder: Path, source: str, max_rows: Any = None) -> tuple[Entry, ...]:
    """The files of a list of recordings: names, or mappings with `file`."""
    if not isinstance(content, list):
        raise LoadError(f"{source}: expected a list of files, got {_shown(content)}")
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
    mapping = checked(content, (*_ENTRY, *TOLD), source)
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
    return Entry(
        name=file,
        path=folder / Path(file).expanduser(),
        role=cast(Role, role),
        topic=text(mapping.get("topic"), f"{source}: topic"),
        command_topic=text(mapping.get("command_topic"), f"{source}: command_topic"),
        part=Part(every=int(every), window=window, max_rows=max_rows),
        told={key: mapping[key] for key in TOLD if mapping.get(key) is not None},
    )


def trust_from(content: Any) -> Trust:
    """The study's `trust`."""
    if content is None:
        return Trust()
    told = checked(content, ("rigid_body", "torque"), "trust")
    shares = {
        key: number(value, f"trust: {key}", least=0.0)
        for key, value in told.items()
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


def vector(content: Any, source: str, count: int, of: str = "numbers") -> FloatArray:
    """A list of numbers of this length."""
    if not isinstance(content, list):
        raise LoadError(f"{source}: expected a list of {count}, got {_shown(content)}")
    if len(content) != count:
        raise LoadError(
            f"{source} has {len(content)} entries, expected {count}"
            + (f": the study has {count} {of}" if of != "numbers" else "")
        )
    return np.array([number(each, source) for each in content], dtype=np.float64)


def number(content: Any, source: str, least: float = -np.inf) -> float:
    """A finite number; YAML reads `1e-3` as text, which is taken too."""
    try:
        value = float("nan" if isinstance(content, bool) else content)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise LoadError(f"{source}: expected a number, got {_shown(content)}")
    if value < least:
        raise LoadError(
            f"{source}: expected {'more than 0' if 0 < least < 1e-300 else f'at least {least:g}'},"
            f" got {value:g}"
        )
    return value


def text(content: Any, source: str) -> str | None:
    """Text, or None."""
    if content is None or isinstance(content, str):
        return content
    raise LoadError(f"{source}: expected text, got {_shown(content)}")


def names(content: Any, source: str) -> tuple[str, ...] | None:
    """A list of names without repetition, or None."""
    if content is None:
        return None
    if not isinstance(content, list) or not content:
        raise LoadError(f"{source}: expected a list of names, got {_shown(content)}")
    found = tuple(str(each) for each in content)
    twice = [each for each in found if found.count(each) > 1]
    if twice:
        raise LoadError(f"{source}: {twice[0]!r} is there more than once")
    return found


def _shown(content: Any) -> str:
    shown = repr(dict(content) if isinstance(content, Mapping) else content)
    return shown if len(shown) < 60 else f"{shown[:57]}..."
