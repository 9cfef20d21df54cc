"""The kinds of logs that are known, and which of them a file is."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..key import Keys
from .log import Log

GROUP = "pdoik.logs"
"""Entry points of this group are kinds of logs of other packages."""

KINDS: dict[str, type[Log]] = {}
"""Kinds of logs by what messages call them."""

_Kind = TypeVar("_Kind", bound=type[Log])
_TEXT = "CSV"  # what a file is taken for that no other kind recognises


def register(kind: _Kind) -> _Kind:
    """Add a kind of log, as a class decorator.

    Raises:
        ValueError: another has its name.
    """
    known = KINDS.get(kind.kind)
    if known is not None and known.__qualname__ != kind.__qualname__:
        raise ValueError(f"there is another kind of log {kind.kind!r}: {known.__name__}")
    KINDS[kind.kind] = kind
    return kind


def entry_keys() -> Keys:
    """What a recording's entry may say for the sake of its kind of log."""
    return {name: key for kind in KINDS.values() for name, key in kind.keys.items()}


def open_log(path: Path, name: str, given: Mapping[str, Any]) -> Log:
    """A log, by its suffix or else by how it begins.

    Args:
        path: Of the file or folder.
        name: What messages call it.
        given: What the recording's entry says besides the file.

    Raises:
        LoadError: there is no such file, it is no log, or has nothing to do with what is given.
    """
    if not path.exists():
        names = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"{name}: no such file: {path}{nearest(path.name, names)}")
    kind = _kind(path, name)
    for key, value in given.items():
        if value is not None and key not in kind.keys:
            have = [each for each, other in KINDS.items() if key in other.keys]
            raise LoadError(
                f"{name}: {key}: is of {' and '.join(have)} only, this file is {kind.kind}"
            )
    return kind(path, name, {key: value for key, value in given.items() if value is not None})


def _kind(path: Path, name: str) -> type[Log]:
    if path.is_dir():
        for kind in KINDS.values():
            if kind.is_folder(path):
                return kind
        raise LoadError(
            f"{name}: a folder in which nothing is known; expected a bag with metadata.yaml or a"
            " LeRobot data set with meta/info.json"
        )
    lower = path.name.lower()
    for kind in KINDS.values():
        if lower.endswith(kind.suffixes):
            return kind
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as error:
        raise LoadError(f"{name}: cannot be read: {error.strerror}") from error
    for kind in KINDS.values():
        if head.startswith(kind.magic or (b"\0no magic",)):
            return kind
    return KINDS[_TEXT]
