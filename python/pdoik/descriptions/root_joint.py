"""URDFs whose first joint lets the whole robot go about, as those of mobile robots have it."""

from __future__ import annotations

import re
import warnings
from xml.etree import ElementTree

from ..errors import RobotWarning

_GOES_ABOUT = re.compile(r"""\btype\s*=\s*["'](?:floating|planar)["']""")


def standing(urdf: str) -> str:
    """The same with floating and planar joints at the root fixed; such joints elsewhere stay.

    Warns:
        RobotWarning: A joint was fixed.
    """
    if not _GOES_ABOUT.search(urdf):
        return urdf
    try:
        robot = ElementTree.fromstring(urdf)
    except ElementTree.ParseError:  # another reader says what is wrong
        return urdf
    joints = robot.findall("joint")
    children = {_link(joint, "child") for joint in joints}
    free = [
        joint
        for joint in joints
        if joint.get("type") in ("floating", "planar") and _link(joint, "parent") not in children
    ]
    for joint in free:
        message = (
            f"joint {joint.get('name')!r} is {joint.get('type')}: the robot stands at its origin;"
            " base_link= below it and floating_base= let it go about"
        )
        warnings.warn(message, RobotWarning, stacklevel=4)
        joint.set("type", "fixed")
    return ElementTree.tostring(robot, encoding="unicode") if free else urdf


def _link(joint: ElementTree.Element, end: str) -> str | None:
    found = joint.find(end)
    return None if found is None else found.get("link")
