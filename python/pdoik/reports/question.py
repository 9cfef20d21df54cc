"""What was asked and what was answered, as a report has them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from .._core import Goal
from ..carried import Carried
from ..options import Options
from .obstacles import read_shape, shape_entry
from .values import Entry, plain

ANSWER = (  # what a replay has to give again
    *("q", "success", "status", "position_error", "rotation_error", "clearance"),
    *("limit_violation", "center_of_mass", "balance_violation", "self_distance"),
    *("worst_constraint", "worst_violation"),
)
FORGIVEN = ("forgiven_contact", "forgiven_depth")  # which older reports do not have
EFFORT = ("iterations", "evaluations", "restarts")
OF_STEPS = ("tracking", "step_limited", "complaint")
CLOCK = ("time", "intake", "late_evaluations")  # what is another one each time


def options_entry(options: Options) -> dict[str, Any]:
    """All of them by name, what is at its default as well: defaults change."""
    entry: dict[str, Any] = plain(dataclasses.asdict(options))
    return entry


def read_options(entry: Entry) -> Options:
    """The same options; those that an older version did not have are as it behaved.

    Raises:
        LoadError: One is unknown, or not what it should be.
    """
    # Before it was an option, a robot without hulls ignored obstacles.
    default = Options(ignore_obstacles_without_hulls=True)
    try:
        options = _fields(default, entry)
    except (TypeError, ValueError) as error:
        if type(error) not in (TypeError, ValueError):  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error
    assert isinstance(options, Options)
    return options


def _fields(default: Any, entry: Entry) -> Any:
    known = {each.name for each in dataclasses.fields(default)}
    for name in entry.names():
        if name not in known:
            raise entry[name].wrong("no option of this version of pdoik")
    values = {name: _option(getattr(default, name), entry[name]) for name in entry.names()}
    return dataclasses.replace(default, **values)


def _option(default: Any, entry: Entry) -> Any:
    if dataclasses.is_dataclass(default):
        return _fields(default, entry)
    if isinstance(default, Mapping):
        return {name: entry[name].array(None, 3) for name in entry.names()}
    if entry.name.endswith(".links"):
        return tuple(each.text() for each in entry.items())
    if isinstance(entry.value, list):
        return tuple(entry.array(None).tolist())
    if isinstance(default, float):
        return entry.number()
    if isinstance(default, bool):
        return entry.boolean()
    return entry.whole() if isinstance(default, int) else entry.value


def carried_entry(carried: tuple[Carried, ...]) -> list[dict[str, Any]]:
    """What `read_carried` reads."""
    return [
        {
            "link": each.link,
            "shapes": [shape_entry(shape) for shape in each.shapes],
            "may_touch": list(each.may_touch),
        }
        for each in carried
    ]


def read_carried(entry: Entry) -> list[Carried]:
    """Arguments of `attach`."""
    return [
        Carried(
            each["link"].text(),
            tuple(read_shape(shape) for shape in each["shapes"].items()),
            tuple(name.text() for name in each["may_touch"].items()),
        )
        for each in entry.items()
    ]


def goals_entry(goals: Any) -> dict[str, Any]:
    """Of whatever a solve, a batch or a step takes as its target."""
    if isinstance(goals, Mapping):
        return {"tips": {str(link): goals_entry(goal) for link, goal in goals.items()}}
    if not isinstance(goals, Goal):
        return {"T_base_tip": plain(np.asarray(goals, dtype=np.float64))}
    entry: dict[str, Any] = {"T_base_tip": plain(goals.T_base_tip)}
    if goals.type is not None:
        entry["type"] = goals.type
    if goals.axis is not None:
        entry["axis"] = plain(goals.axis)
    slack = {"position_slack": goals.position_slack, "rotation_slack": goals.rotation_slack}
    return entry | {"weight": goals.weight} | {name: plain(each) for name, each in slack.items()}


def read_goals(entry: Entry, *, batch: bool = False, nan: bool = False) -> Any:
    """The same again.

    Args:
        entry: Of the file.
        batch: Of many targets.
        nan: A tracker says what it makes of NaN.
    """
    if "tips" in entry.names():
        tips = entry["tips"]
        return {link: read_goals(tips[link], batch=batch, nan=nan) for link in tips.names()}
    target = entry["T_base_tip"]
    if batch:
        return target.array(None, 4, 4)
    is_point = isinstance(target.value, list) and len(target.value) == 3
    T = target.array(*((3,) if is_point else (4, 4)), nan=nan)
    if "weight" not in entry.names():
        return T
    try:
        return Goal(
            T,
            type=None if entry.get("type").value is None else entry["type"].text(),
            axis=entry.get("axis").array_or_none(3),
            weight=entry["weight"].number(),
            position_slack=entry["position_slack"].array(3),
            rotation_slack=entry["rotation_slack"].array(3),
        )
    except ValueError as error:
        if type(error) is not ValueError:
            raise
        raise entry.wrong(str(error)) from error


def answer_entry(result: Any) -> dict[str, Any]:
    """Of a Result or a TrackerResult."""
    names = [
        *ANSWER,
        *FORGIVEN,
        *EFFORT,
        *(name for name in OF_STEPS if hasattr(result, name)),
        *CLOCK,
    ]
    return {name: plain(getattr(result, name)) for name in names}


def read_answer(entry: Entry, dof: int) -> dict[str, Any]:
    """By name, with the types that a Result has.

    Raises:
        LoadError: Something is missing or is no such thing.
    """
    answer: dict[str, Any] = {}
    for name in entry.names():
        value = entry[name]
        if name == "q":
            answer[name] = value.array(dof, nan=True)
        elif name == "center_of_mass":
            answer[name] = value.array(3)
        elif name == "success":
            answer[name] = value.boolean()
        elif name in ("status", "worst_constraint", "forgiven_contact", "tracking", "complaint"):
            answer[name] = value.text()
        elif name in ("iterations", "evaluations", "restarts", "late_evaluations"):
            answer[name] = value.whole()
        elif name == "step_limited":
            answer[name] = None if value.value is None else value.text()
        else:
            answer[name] = value.number()
    for name in (*ANSWER, *EFFORT, *CLOCK):
        entry[name]  # or it is missing
    return answer
