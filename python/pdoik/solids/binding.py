"""What the worst constraint is about, as things that can be marked."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

import pdoik
from pdoik._hulls import hull_names

_NUMBER = re.compile(r" \((?:sphere|spheroid|capsule) \d+\)")
_START, _POINT = "clearance of ", "obstacle "


class Binding(NamedTuple):
    """Where the worst constraint is a clearance: between which things it is."""

    hulls: tuple[int, ...] = ()  # in the order of `placed_hulls`
    held: tuple[str, ...] = ()  # what is attached to links, by name
    obstacle: int | None = None  # the row of a point
    shape: str | None = None  # by name


def binding(
    result: pdoik.Result,
    robot: pdoik.Robot,
    shapes: Collection[str] = (),
    held: Collection[str] = (),
) -> Binding:
    """The two things that the worst constraint names.

    Args:
        result: Whose.
        robot: Whose hulls.
        shapes: The names of those that there are.
        held: The names of what is attached to links.
    """
    hulls = {name: number for number, name in enumerate(hull_names(robot))}
    rest = result.worst_constraint
    if not rest.startswith(_START):
        return Binding()
    words = rest.removeprefix(_START).split(" to ")
    for k in range(1, len(words)):  # names may have the word, too
        first, second = " to ".join(words[:k]), " to ".join(words[k:])
        if first not in hulls and first not in held:
            continue
        numbers = tuple(hulls[each] for each in (first, second) if each in hulls)
        attached = tuple(each for each in (first, second) if each in held)
        if second.startswith(_POINT) and second.removeprefix(_POINT).isdecimal():
            return Binding(numbers, attached, obstacle=int(second.removeprefix(_POINT)))
        if second in shapes:
            return Binding(numbers[:1], attached[:1], shape=second)
        if len(numbers) + len(attached) == 2:
            return Binding(numbers, attached)
    return Binding()


def clearances_of(
    found: Binding, clearances: Sequence[pdoik.ObstacleClearance]
) -> list[pdoik.ObstacleClearance]:
    """Those of the obstacle that a constraint names, though others be nearer that may; or all."""
    if found.shape is not None:
        return [each for each in clearances if each.obstacle == found.shape]
    if found.obstacle is not None:
        return [each for each in clearances if each.point is not None]
    return list(clearances)


def without_numbers(text: str) -> str:
    """What a result says without the numbers of hulls, where these are drawn: links remain."""
    return _NUMBER.sub("", text)
