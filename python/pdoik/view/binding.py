"""Which constraint binds, in words and as things to paint red."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

import pdoik

_HULL = re.compile(r"\((sphere|spheroid|capsule) (\d+)\)")
_OBSTACLE = re.compile(r" to obstacle (\d+)$")
_SHAPE = re.compile(r"^(clearance of .*?\((?:sphere|spheroid|capsule) \d+\)) to (.+)$")


class Binding(NamedTuple):
    """Where the worst constraint is a clearance: of which hulls, to which point or shape."""

    hulls: tuple[int, ...]  # in the order of `placed_hulls`
    obstacle: int | None
    shape: str | None


def binding(result: pdoik.Result, robot: pdoik.Robot, shapes: Collection[str] = ()) -> Binding:
    """The hulls and the point or shape that the worst constraint names.

    Args:
        result: Whose.
        robot: Whose hulls.
        shapes: The names of those that there are.
    """
    text, shape = result.worst_constraint, None
    named = _SHAPE.match(text)
    if named is not None and named[2] in shapes:
        text, shape = named[1], named[2]
    spheres, spheroids = len(robot.occupancy.spheres), len(robot.occupancy.spheroids)
    before = {"sphere": 0, "spheroid": spheres, "capsule": spheres + spheroids}
    hulls = _HULL.findall(text)
    point = _OBSTACLE.search(text)
    return Binding(
        hulls=tuple(before[kind] + int(index) for kind, index in hulls),
        obstacle=None if point is None else int(point[1]),
        shape=shape,
    )


def margin_text(result: pdoik.Result, robot: pdoik.Robot) -> str:
    """By how much the worst constraint is missed, or holds."""
    amount = f"{1e3 * abs(result.worst_violation):.3g} {_unit(result, robot)}"
    return f"missed by {amount}" if result.worst_violation > 0 else f"holds, {amount} to spare"


def _unit(result: pdoik.Result, robot: pdoik.Robot) -> str:
    """Of a thousandth of the worst constraint."""
    name = result.worst_constraint
    if name.startswith("limit of "):
        kinds = dict(zip(robot.joint_names, robot.joint_types, strict=True))
        return "mm" if kinds.get(name.removeprefix("limit of ")) == "prismatic" else "mrad"
    return "mrad" if name.startswith("rotation") else "mm"
