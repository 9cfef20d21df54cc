"""A URDF's own text with other figures in it."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik.descriptions import rotation_of_rpy
from pdoik.recordings import FloatArray

from ..simulation import (
    DofChange,
    HardFriction,
    Inertial,
    LinkChange,
    Part,
    Placement,
    changed_inertials,
    nearest,
    read_description,
)


def improve_urdf(
    text: str, joints: tuple[str, ...], parts: Sequence[Part], comment: Iterable[str] = ()
) -> str:
    """Damping, friction, inertials and joint frames with `parts`; everything else stays.

    Raises:
        ValueError: a part is of a joint or link that is not there.
    """
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    root = ElementTree.fromstring(text, parser)
    lines = [line.replace("--", "- -") for line in comment]
    root.insert(0, ElementTree.Comment("\n" + "".join(f"    {line}\n" for line in lines) + "  "))
    elements = {each.get("name", ""): each for each in root.findall("joint")}
    damping: dict[str, float] = {}
    friction: dict[str, float] = {}
    for part in parts:
        if isinstance(part, DofChange):
            damping[part.joint] = damping.get(part.joint, 0.0) + part.damping
        elif isinstance(part, HardFriction) and not callable(part.level):
            friction[part.joint] = friction.get(part.joint, 0.0) + part.level
        elif isinstance(part, Placement):
            _move(elements[nearest(part.joint, elements, "joint")], part)
    for name, values in (("damping", damping), ("friction", friction)):
        for joint, value in values.items():
            dynamics = _child(elements[nearest(joint, elements, "joint")], "dynamics")
            dynamics.set(name, repr(float(dynamics.get(name, 0.0)) + value))
    _set_inertials(root, text, joints, parts)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _set_inertials(
    root: ElementTree.Element, text: str, joints: tuple[str, ...], parts: Sequence[Part]
) -> None:
    changes = [part for part in parts if isinstance(part, LinkChange)]
    if not changes:
        return
    described = read_description(text)
    links = described.links_of(joints)
    inertials = changed_inertials(described, links, changes)
    elements = {each.get("name", ""): each for each in root.findall("link")}
    for link in dict.fromkeys(change.link or links[-1] for change in changes):
        _set_inertial(elements[link], inertials[link].nearest_body())


def _set_inertial(link: ElementTree.Element, inertial: Inertial) -> None:
    for old in link.findall("inertial"):
        link.remove(old)
    element = ElementTree.Element("inertial")
    link.insert(0, element)
    ElementTree.SubElement(element, "origin", {"xyz": _text(inertial.com), "rpy": "0 0 0"})
    ElementTree.SubElement(element, "mass", {"value": _text([inertial.mass])})
    I = inertial.inertia_about_com  # noqa: E741
    names = [(a, b) for a in range(3) for b in range(a, 3)]
    ElementTree.SubElement(
        element, "inertia", {f"i{'xyz'[a]}{'xyz'[b]}": _text([I[a, b]]) for a, b in names}
    )


def _move(joint: ElementTree.Element, part: Placement) -> None:
    """The joint's origin times the placement."""
    origin = _child(joint, "origin")
    xyz = np.array([float(each) for each in origin.get("xyz", "0 0 0").split()])
    R = rotation_of_rpy(np.array([float(each) for each in origin.get("rpy", "0 0 0").split()]))
    xyz = xyz + np.array(part.shift) + R @ np.array(part.translation)
    R = R @ Rotation.from_rotvec(part.rotation).as_matrix()
    origin.set("xyz", _text(xyz))
    origin.set("rpy", _text(_rpy(R)))


def _rpy(R: FloatArray) -> tuple[float, float, float]:
    """Roll, pitch, yaw of R_z R_y R_x; roll is 0 where only one of roll and yaw is determined."""
    pitch = float(np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0])))
    if np.hypot(R[0, 0], R[1, 0]) < 1e-9:
        return 0.0, pitch, float(np.arctan2(-R[0, 1], R[1, 1]))
    roll, yaw = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(R[1, 0], R[0, 0])
    return float(roll), pitch, float(yaw)


def _child(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.17g}" for value in values)
