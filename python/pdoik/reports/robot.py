"""A robot as a report has it: links and joints as numbers, hulls, pairs that may touch."""

from __future__ import annotations

from typing import Any

from .._core import Occupancy, Robot
from .values import Entry, plain

JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic")  # in C++'s order
_LINK = ("name", "mass", "center_of_mass", "inertia")
_JOINT = (
    *("name", "type", "parent", "child", "T_parent_child", "axis"),
    *("lower", "upper", "velocity", "effort", "mimic"),
)


def robot_entry(robot: Robot) -> dict[str, Any]:
    """What `read_robot` reads; SI units, each number to the bit."""
    name, links, joints, base_link, tip_links, occupancy, pairs = robot.__getstate__()
    return {
        "name": name,
        "base_link": base_link,
        "tip_links": tip_links,
        "links": [dict(zip(_LINK, plain(link), strict=True)) for link in links],
        "joints": [
            {**dict(zip(_JOINT, plain(joint), strict=True)), "type": JOINT_TYPES[joint[1]]}
            for joint in joints
        ],
        "hulls": {
            "spheres": plain(occupancy.spheres),
            "spheroids": plain(occupancy.spheroids),
            "capsules": plain(occupancy.capsules),
            "pieces": plain(occupancy.pieces),
        },
        "ignored_pairs": plain(pairs),
    }


def read_robot(entry: Entry) -> Robot:
    """The same robot again.

    Raises:
        LoadError: Names the entry and what is wrong with it.
    """
    state = (
        entry["name"].text(),
        [_link(each) for each in entry["links"].items()],
        [_joint(each) for each in entry["joints"].items()],
        entry["base_link"].text(),
        [each.text() for each in entry["tip_links"].items()],
        _occupancy(entry["hulls"]),
        [_row(each, str, str) for each in entry["ignored_pairs"].items()],
    )
    robot = Robot.__new__(Robot)
    try:
        robot.__setstate__(state)
    except ValueError as error:
        raise entry.wrong(str(error)) from error
    return robot


def _link(entry: Entry) -> tuple[Any, ...]:
    return (
        entry["name"].text(),
        entry["mass"].number(),
        entry["center_of_mass"].array(3),
        entry["inertia"].array(3, 3),
    )


def _joint(entry: Entry) -> tuple[Any, ...]:
    mimic = entry["mimic"]
    return (
        entry["name"].text(),
        JOINT_TYPES.index(entry["type"].text(*JOINT_TYPES)),
        entry["parent"].text(),
        entry["child"].text(),
        entry["T_parent_child"].array(4, 4),
        entry["axis"].array(3),
        *(entry[name].number() for name in ("lower", "upper", "velocity", "effort")),
        None if mimic.value is None else _row(mimic, str, float, float),
    )


def _occupancy(entry: Entry) -> Occupancy:
    rows: dict[str, list[Any]] = {
        name: [_row(each, *kinds) for each in entry[name].items()]
        for name, kinds in {
            "spheres": (str, tuple, float),
            "spheroids": (str, tuple, str, tuple, float),
            "capsules": (str, tuple, tuple, float, float),
        }.items()
    }
    pieces = entry.get("pieces")  # which files of before have not
    rows["pieces"] = [] if pieces.value is None else [_piece(each) for each in pieces.items()]
    return Occupancy(**rows)


def _piece(entry: Entry) -> tuple[Any, ...]:
    """A link, its piece's vertices and triangles, and its tolerance."""
    parts = entry.items()
    if len(parts) != 4:
        raise entry.expected("4 entries")
    link, vertices, triangles, tolerance = parts
    corners = [[each.whole() for each in row.items()] for row in triangles.items()]
    return link.text(), vertices.array(None, 3), corners, tolerance.number()


def _row(entry: Entry, *kinds: type) -> tuple[Any, ...]:
    """A list of a text, a number or a point each."""
    parts = entry.items()
    if len(parts) != len(kinds):
        raise entry.expected(f"{len(kinds)} entries")
    return tuple(
        part.text() if kind is str else part.number() if kind is float else tuple(part.array(3))
        for part, kind in zip(parts, kinds, strict=True)
    )
