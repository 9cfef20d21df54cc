"""Whether a robot's joints are those of the URDF it was read from, by another parser."""

from __future__ import annotations

import numpy as np

from .._core import Robot
from ..descriptions import tree_of, urdf_joints
from .robot import JOINT_TYPES

_ROUNDING = 1e-9  # [m], of a rotation's entries, [rad]


def misread(urdf: str, robot: Robot) -> list[str]:
    """What of the URDF's joints the robot has otherwise, in words.

    Raises:
        LoadError: It is no URDF.
    """
    joints = {joint[0]: joint for joint in robot.__getstate__()[2]}
    found = []
    for given in urdf_joints(tree_of(urdf)):
        if given.name not in joints:
            found.append(f"the URDF's joint {given.name} is not in the robot")
            continue
        _, kind, parent, child, T, axis, lower, upper, *_ = joints[given.name]
        same = {
            "type": given.type == JOINT_TYPES[kind],
            "links": [given.parent, given.child] == [parent, child],
            "origin": np.abs(given.T_parent_child - T).max() < _ROUNDING,
        }
        if JOINT_TYPES[kind] != "fixed":
            off = given.axis - axis / np.linalg.norm(axis)
            same["axis"] = np.abs(off).max() < _ROUNDING
        if JOINT_TYPES[kind] in ("revolute", "prismatic"):
            limits = [given.limit(end) or 0.0 for end in ("lower", "upper")]
            same["limits"] = np.abs(np.subtract(limits, [lower, upper])).max() < _ROUNDING
        wrong = [what for what, is_so in same.items() if not is_so]
        if wrong:
            found.append(f"{' and '.join(wrong)} of joint {given.name} is not the URDF's")
    return found
