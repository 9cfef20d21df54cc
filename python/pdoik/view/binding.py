"""Which constraint binds, in words and as things to paint red."""

from __future__ import annotations

import re
from typing import NamedTuple

import pdoik

_HULL = re.compile(r"\((sphere|spheroid) (\d+)\)")
_OBSTACLE = re.compile(r" to obstacle (\d+)$")


class Binding(NamedTuple):
    """Where the worst constraint is a clearance: its hulls and obstacle point, by index."""

    hulls: tuple[int, ...]  # in the order of `placed_hulls`: spheres, then spheroids
    obstacle: int | None


def binding(result: pdoik.Result, robot: pdoik.Robot) -> Binding:
    """The hulls and the point that the worst constraint names."""
    before = {"sphere": 0, "spheroid": len(robot.occupancy.spheres)}
    hulls = _HULL.findall(result.worst_constraint)
    point = _OBSTACLE.search(result.worst_constraint)
    return Binding(
        hulls=tuple(before[kind] + int(index) for kind, index in hulls),
        obstacle=None if point is None else int(point[1]),
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
