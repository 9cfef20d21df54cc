"""What was asked and what was answered, as a report has them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from .._core import Attachment
from ..options import Options
from .contacts import read_rule, rule_entry
from .obstacles import read_shape, shape_entry
from .values import Entry, plain

ANSWER = (  # what a replay has to give again
    *("q", "success", "status", "position_error", "rotation_error", "clearance"),
    *("limit_violation", "center_of_mass", "balance_violation", "self_distance"),
    *("worst_constraint", "worst_violation"),
)
LATER = (  # which older reports do not have
    *("goal_index", "message"),
)
EFFORT = ("iterations", "evaluations", "restarts")
OF_STEPS = ("tracking", "step_limited", "complaint")
FOUND = ("turns", "complete", "coverage", "status", "restarts", "time")  # of all solutions
_TEXTS = (*("status", "worst_constraint", "message", "tracking", "complaint"),)
_GONE = [("forgive_overhang", False)]  # options of before, as which this version behaves
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
    names = [name for name in entry.names() if (name, entry[name].value) not in _GONE]
    for name in names:
        if name not in known:
            raise entry[name].wrong("no option of this version of pdoik")
    values = {name: _option(getattr(default, name), entry[name]) for name in names}
    return dataclasses.replace(default, **values)


def _option(default: Any, entry: Entry) -> Any:
    if dataclasses.is_dataclass(default):
        return _fields(default, entry)
    if isinstance(default, Mapping):
        return {name: entry[name].array(None, 3) for name in entry.names()}
    if entry.name.endswith(".links"):
        return tuple(each.text() for each in entry.items())
    if entry.name.endswith(".T_tip_tool"):
        return entry.array(4, 4)
    if isinstance(entry.value, list):
        return tuple(entry.array(None).tolist())
    if isinstance(default, float):
        return entry.number()
    if isinstance(default, bool):
        return entry.boolean()
    return entry.whole() if isinstance(default, int) else entry.value


def carried_entry(carried: Sequence[Attachment]) -> list[dict[str, Any]]:
    """What `read_carried` reads."""
    return [
        {
            "links": list(each.links),
            "shapes": [shape_entry(shape) for shape in each.shapes],
            "contacts": [rule_entry(rule) for rule in each.contacts],
        }
        for each in carried
    ]


def read_carried(entry: Entry) -> list[Attachment]:
    """Attachments for `attach_all`."""
    return [_read_attachment(each) for each in entry.items()]


def _read_attachment(entry: Entry) -> Attachment:
    shapes = [read_shape(shape) for shape in entry["shapes"].items()]
    if "link" in entry.names():  # of before there were rules
        may_touch = [name.text() for name in entry["may_touch"].items()]
        return Attachment(entry["link"].text(), shapes, may_touch)
    links = [link.text() for link in entry["links"].items()]
    contacts = [read_rule(rule) for rule in entry["contacts"].items()]
    return Attachment(links, shapes, contacts=contacts)


def answer_entry(result: Any) -> dict[str, Any]:
    """Entry of a Result or a TrackerResult."""
    names = [
        *ANSWER,
        *LATER,
        *EFFORT,
        *(name for name in OF_STEPS if hasattr(result, name)),
        *CLOCK,
    ]
    return {name: plain(getattr(result, name)) for name in names}


def read_answer(entry: Entry, dof: int) -> dict[str, Any]:
    """Values by name, with the types that a Result has.

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
        elif name in _TEXTS:
            answer[name] = value.text()
        elif name in (*EFFORT, "late_evaluations", "goal_index"):
            answer[name] = value.whole()
        elif name == "step_limited":
            answer[name] = None if value.value is None else value.text()
        else:
            answer[name] = value.number()
    for name in (*ANSWER, *EFFORT, *CLOCK):
        entry[name]  # or it is missing
    return answer


def found_entry(solutions: Any) -> dict[str, Any]:
    """Entry of Solutions, what is none of its results'."""
    return {name: plain(getattr(solutions, name)) for name in FOUND}


def read_found(entry: Entry, count: int) -> dict[str, Any]:
    """Values by name, of `count` solutions."""
    turns = entry["turns"].items()
    if len(turns) != count:
        raise entry["turns"].wrong(f"expected {count}, one for each answer, got {len(turns)}")
    return {
        "turns": [each.whole() for each in turns],
        "complete": entry["complete"].boolean(),
        "coverage": entry["coverage"].number(),
        "status": entry["status"].text(),
        "restarts": entry["restarts"].whole(),
        "time": entry["time"].number(),
    }
