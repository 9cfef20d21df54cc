"""The key `columns:`, which settles what names do not."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..columns import CONTACT, SUPPLY, VECTORS, channel_of, pose_columns
from ..logs import Column
from ..recording import CHANNELS

_PLACES = {"{joint}": r"(?P<joint>.+)", "{index}": r"(?P<index>\d+)"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Match:
    """A column that is mapped."""

    column: Column
    target: str  # "time", "q", "q.elbow", "volts", "tip.x"
    joint: str | None = None  # as the pattern found it in the name
    index: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnsKey:
    """Targets by what they are read from: exact names, or patterns with {joint} or {index}."""

    sources: dict[str, str] = field(default_factory=dict)  # by target
    optional: bool = False  # whether a log may lack them

    def matches(self, columns: Collection[Column]) -> dict[str, list[Match]]:
        """Columns by the target that they are given, none where a log has no such name."""
        return {
            target: [each for column in columns if (each := _match(target, source, column))]
            for target, source in self.sources.items()
        }


def columns_key(content: Any, source: str) -> ColumnsKey:
    """The key's sources, of `{q: "actual_q_{index}", tau.elbow: "torque 2", time: stamp}`.

    Under a channel there may also be the joints' names: `{q: {elbow: "enc2"}}`.

    Raises:
        LoadError: a key is no channel, or a value no name or pattern.
    """
    if content is None:
        return ColumnsKey()
    if not isinstance(content, dict):
        raise LoadError(
            f"{source}: expected '{{q: \"pos_{{joint}}\"}}' or the like, got {content!r}"
        )
    sources: dict[str, str] = {}
    for key, value in content.items():
        if isinstance(value, dict) and key in CHANNELS:
            for joint, name in value.items():
                sources[f"{key}.{joint}"] = _source(name, f"{source}: {key}.{joint}", False)
        else:
            _check_target(str(key), source)
            sources[str(key)] = _source(value, f"{source}: {key}", str(key) in CHANNELS)
    return ColumnsKey(sources=sources)


def _check_target(target: str, source: str) -> None:
    imu = tuple(f"{of}.{axis}" for of, axes in VECTORS.items() for axis in axes)
    single = ("time", SUPPLY, *pose_columns("tip"), *pose_columns("base"), *imu)
    known = target in CHANNELS or target in single or target.startswith(CONTACT)
    if not known and channel_of(target) is None:
        channel, dot, _joint = target.partition(".")
        near = nearest(channel if dot else target, (*CHANNELS, *single))
        raise LoadError(
            f"{source}: no channel {target!r}{near}; expected one of {', '.join(CHANNELS)}, alone"
            " or as '<channel>.<joint>', or time"
        )


def _source(value: Any, source: str, many: bool) -> str:
    if not isinstance(value, str) or not value:
        raise LoadError(f"{source}: expected a column's name, got {value!r}")
    there = [place for place in _PLACES if place in value]
    if many and len(there) != 1:
        raise LoadError(
            f"{source}: expected a pattern with '{{joint}}' or '{{index}}', got {value!r}; the"
            f" column of one joint is mapped as '{source.rpartition(' ')[2]}.<joint>: {value}'"
        )
    return value


def _match(target: str, source: str, column: Column) -> Match | None:
    labelled = f"{column.array}.{column.label}" if column.label else column.name
    if target not in CHANNELS:
        there = source in (column.name, labelled)
        return Match(column=column, target=target) if there else None
    parts = re.split(r"(\{joint\}|\{index\})", source)
    pattern = "".join(_PLACES.get(each, re.escape(each)) for each in parts)
    for name in (labelled, column.name):
        found = re.fullmatch(pattern, name)
        if found is not None:
            groups = found.groupdict()
            index = groups.get("index")
            return Match(
                column=column,
                target=target,
                joint=groups.get("joint"),
                index=None if index is None else int(index),
            )
    return None
