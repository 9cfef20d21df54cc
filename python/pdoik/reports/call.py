"""What one call says besides goals and obstacles: start, posture, locks, tool, priority."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .values import Entry, FloatArray, plain

CALLS = {"solve": "solve", "solve_batch": "batch", "solve_any": "any", "solve_all": "all"}
"""The kind of a report by the method that was called."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """Arguments of one answer's call; what is not given is the options'.

    Attributes:
        lock: Joints that keep a position, by name [rad] or [m].
        T_tip_tool: (4, 4) [m], or that by tip link.
        priority: "position", "both" or None.
    """

    lock: Mapping[str, float] = field(default_factory=dict)
    T_tip_tool: FloatArray | Mapping[str, FloatArray] | None = None
    priority: str | None = None


def call_entry(
    *, vectors: Mapping[str, ArrayLike | None], lock: Any, T_tip_tool: Any, priority: str | None
) -> dict[str, Any]:
    """What `read_keywords` reads.

    Args:
        vectors: q0, posture and max_step.
        lock: A dict of positions by joint, or of a batch a list of them.
        T_tip_tool: A matrix, or a dict of such by tip link.
        priority: As it was given.
    """
    entry: dict[str, Any] = {
        name: None if value is None else plain(np.asarray(value, dtype=np.float64))
        for name, value in vectors.items()
    }
    if isinstance(lock, Mapping):
        entry["lock"] = _positions(lock)
    else:
        entry["lock"] = None if lock is None else [_positions(each) for each in lock]
    if isinstance(T_tip_tool, Mapping):
        entry["T_tip_tool"] = {
            str(link): plain(np.asarray(T, dtype=np.float64)) for link, T in T_tip_tool.items()
        }
    else:
        is_given = T_tip_tool is not None
        entry["T_tip_tool"] = plain(np.asarray(T_tip_tool, dtype=float)) if is_given else None
    return entry | {"priority": priority}


def read_keywords(question: Entry, dof: int, kind: str) -> dict[str, Any]:
    """Arguments of the method that was called; older reports have fewer of them."""
    keywords: dict[str, Any] = {}
    for name in ("q0", "posture", "max_step"):
        value = question[name]
        rows = isinstance(value.value, list) and any(isinstance(row, list) for row in value.value)
        keywords[name] = value.array_or_none(*((None, dof) if rows and kind == "batch" else (dof,)))
    keywords["lock"] = _read(question.get("lock"), _read_locks)
    keywords["T_tip_tool"] = _read(question.get("T_tip_tool"), _read_tools)
    keywords["priority"] = _read(question.get("priority"), lambda each: each.text())
    if kind == "any":
        keywords["costs"] = question.get("costs").array_or_none(None)
    if kind == "all":
        keywords["limit"] = _read(question.get("limit"), lambda each: each.whole())
        keywords["distinct"] = _read(question.get("distinct"), lambda each: each.number())
        del keywords["priority"]
    return keywords


def calls_of(keywords: Mapping[str, Any], count: int) -> list[Call]:
    """What was said of each of `count` answers."""
    lock = keywords["lock"]
    locks = lock if isinstance(lock, list) else [lock or {}] * count
    tool, priority = keywords["T_tip_tool"], keywords.get("priority")
    return [Call(lock=each, T_tip_tool=tool, priority=priority) for each in locks]


def _positions(lock: Mapping[str, Any]) -> dict[str, float]:
    return {str(joint): float(position) for joint, position in lock.items()}


def _read(entry: Entry, reader: Callable[[Entry], Any]) -> Any:
    return None if entry.value is None else reader(entry)


def _read_locks(entry: Entry) -> Any:
    if isinstance(entry.value, list):
        return [_read_locks(each) for each in entry.items()]
    return {joint: entry[joint].number() for joint in entry.names()}


def _read_tools(entry: Entry) -> Any:
    if isinstance(entry.value, Mapping):
        return {link: entry[link].array(4, 4) for link in entry.names()}
    return entry.array(4, 4)
