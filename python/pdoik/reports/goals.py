"""Goals as a report has them: all that a Goal says, in lists and by tip."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from .._core import Goal
from ..errors import GoalWarning
from .values import Entry, plain

_WORDS = ("type", "relative_to", "tip", "priority")
_ARRAYS = {"axis": (3,), "T_tip_tool": (4, 4), "position_slack": (3,), "rotation_slack": (3,)}
_NUMBERS = ("weight", "position_tolerance", "rotation_tolerance")
_FLAGS = ("soft", "stands")


def is_list_of_goals(goals: Any) -> bool:
    """Whether this is a list or tuple of goals and their like, not of numbers."""
    if not isinstance(goals, list | tuple):
        return False
    return not goals or isinstance(goals[0], Goal | Mapping) or is_list_of_goals(goals[0])


def goals_entry(goals: Any) -> dict[str, Any]:
    """Entry of whatever a solve, a batch or a step takes as its target."""
    if isinstance(goals, Mapping):
        return {"tips": {str(link): goals_entry(goal) for link, goal in goals.items()}}
    if is_list_of_goals(goals):
        return {"goals": [goals_entry(goal) for goal in goals]}
    if not isinstance(goals, Goal):
        return {"T_base_tip": plain(np.asarray(goals, dtype=np.float64))}
    names = ("T_base_tip", *_WORDS, *_ARRAYS, *_NUMBERS, *_FLAGS)
    values = {name: getattr(goals, name) for name in names}
    return {name: plain(value) for name, value in values.items() if value is not None}


def alternatives_entry(goals: Any) -> dict[str, Any]:
    """Entry of what `solve_any` takes: targets (N, 4, 4), or a list of what `solve` takes."""
    if isinstance(goals, list | tuple):
        return {"goals": [goals_entry(goal) for goal in goals]}
    return goals_entry(goals)


def read_goals(entry: Entry, *, batch: bool = False, nan: bool = False) -> Any:
    """The same again.

    Args:
        entry: Of the file.
        batch: Of many targets, or of alternatives.
        nan: A tracker says what it makes of NaN.
    """
    names = entry.names()
    if "tips" in names:
        tips = entry["tips"]
        return {link: read_goals(tips[link], batch=batch, nan=nan) for link in tips.names()}
    if "goals" in names:
        return [read_goals(each, nan=nan) for each in entry["goals"].items()]
    target = entry["T_base_tip"]
    if batch:
        return target.array(None, 4, 4)
    is_point = isinstance(target.value, list) and len(target.value) == 3
    T = target.array(*((3,) if is_point else (4, 4)), nan=nan)
    if "weight" not in names:
        return T
    keywords: dict[str, Any] = {name: entry[name].text() for name in _WORDS if name in names}
    keywords |= {name: entry[name].array(*_ARRAYS[name]) for name in _ARRAYS if name in names}
    keywords |= {name: entry[name].number() for name in _NUMBERS if name in names}
    keywords |= {name: entry[name].boolean() for name in _FLAGS if name in names}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GoalWarning)  # who asked was warned
            return Goal(T, **keywords)
    except ValueError as error:
        if type(error) is not ValueError:
            raise
        raise entry.wrong(str(error)) from error


def each_of(targets: Any) -> list[Any]:
    """The goals of each answer of a batch, or of each alternative."""
    if not isinstance(targets, Mapping):
        return list(targets)
    return [
        dict(zip(targets, row, strict=True)) for row in zip(*targets.values(), strict=False)
    ]  # of different lengths: the solver says so
