"""Whether a robot's joints are those of the URDF it was read from, by another parser."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np

from .._core import Robot
from .robot import JOINT_TYPES
from .values import FloatArray

_ROUNDING = 1e-9  # [m], of a rotation's entries, [rad]


def misread(urdf: str, robot: Robot) -> list[str]:
    """What of the URDF's joints the robot has otherwise, in words.

    Raises:
        ValueError: It is no XML.
    """
    try:
        elements = ElementTree.fromstring(urdf).findall("joint")
        joints = {joint[0]: joint for joint in robot.__getstate__()[2]}
        found = []
        for element in elements:
            name = element.attrib["name"]
            if name not in joints:
                found.append(f"the URDF's joint {name} is not in the robot")
                continue
            _, kind, parent, child, T, axis, lower, upper, *_ = joints[name]
            ends = [_child(element, tag)["link"] for tag in ("parent", "child")]
            same = {
                "type": element.attrib["type"] == JOINT_TYPES[kind],
                "links": ends == [parent, child],
                "origin": np.abs(_pose(_child(element, "origin")) - T).max() < _ROUNDING,
            }
            if JOINT_TYPES[kind] != "fixed":
                given = _numbers(_child(element, "axis").get("xyz", "1 0 0"))
                off = given / np.linalg.norm(given) - axis / np.linalg.norm(axis)
                same["axis"] = np.abs(off).max() < _ROUNDING
            if JOINT_TYPES[kind] in ("revolute", "prismatic"):
                limit = _child(element, "limit")
                limits = [float(limit.get(end, 0.0)) for end in ("lower", "upper")]
                same["limits"] = np.abs(np.subtract(limits, [lower, upper])).max() < _ROUNDING
            wrong = [what for what, is_so in same.items() if not is_so]
            if wrong:
                found.append(f"{' and '.join(wrong)} of joint {name} is not the URDF's")
    except (ElementTree.ParseError, KeyError) as error:
        raise ValueError(f"no URDF: {error}") from error
    return found


def _child(element: ElementTree.Element, tag: str) -> dict[str, str]:
    found = element.find(tag)
    return {} if found is None else found.attrib


def _numbers(text: str) -> FloatArray:
    return np.array([float(word) for word in text.split()])


def _pose(origin: dict[str, str]) -> FloatArray:
    """Of xyz and rpy, which turn about x, y and z in this order, (4, 4)."""
    T = np.eye(4)
    T[:3, 3] = _numbers(origin.get("xyz", "0 0 0"))
    for k, angle in enumerate(_numbers(origin.get("rpy", "0 0 0"))):
        turn, (i, j) = np.eye(3), [(1, 2), (2, 0), (0, 1)][k]
        turn[[i, j], [i, j]] = np.cos(angle)
        turn[i, j], turn[j, i] = -np.sin(angle), np.sin(angle)
        T[:3, :3] = turn @ T[:3, :3]
    return T
