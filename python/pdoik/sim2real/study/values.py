"""Types of the values in a study's text."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from pdoik._nearest import nearest
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

_LONG = 60  # numerics: characters of a message


def checked(content: Any, keys: Collection[str], source: str) -> dict[str, Any]:
    """`content` as a mapping that has these keys only."""
    if not isinstance(content, dict):
        raise LoadError(f"{source}: expected 'key: value' lines, got {shown(content)}")
    for key in content:
        if key not in keys:
            known = nearest(str(key), keys) or f"; expected one of {', '.join(keys)}"
            raise LoadError(f"{source}: unknown key {key!r}{known}")
    return content


def vector(content: Any, source: str, count: int, of: str = "numbers") -> FloatArray:
    """A list of numbers of this length."""
    if not isinstance(content, list):
        raise LoadError(f"{source}: expected a list of {count}, got {shown(content)}")
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
        raise LoadError(f"{source}: expected a number, got {shown(content)}")
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
    raise LoadError(f"{source}: expected text, got {shown(content)}")


def names(content: Any, source: str) -> tuple[str, ...] | None:
    """A list of names without repetition, or None."""
    if content is None:
        return None
    if not isinstance(content, list) or not content:
        raise LoadError(f"{source}: expected a list of names, got {shown(content)}")
    found = tuple(str(each) for each in content)
    twice = [each for each in found if found.count(each) > 1]
    if twice:
        raise LoadError(f"{source}: {twice[0]!r} is there more than once")
    return found


def shown(content: Any) -> str:
    """What came, for a message."""
    said = repr(dict(content) if isinstance(content, Mapping) else content)
    return said if len(said) < _LONG else f"{said[:57]}..."
