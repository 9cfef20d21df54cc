"""The XML of a robot's description: its tree, and what stands in elements of a URDF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from string import whitespace
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import numpy.typing as npt

from ..errors import LoadError

FloatArray = npt.NDArray[np.float64]


def xml_text(source: str | Path) -> str | None:
    """XML text from its first `<` on; None where the source is a file's path."""
    text = source.lstrip("\ufeff" + whitespace) if isinstance(source, str) else ""
    return text if text.startswith("<") else None


def tree_of(source: str | Path) -> Element:
    """The root element of a file, or of XML text (recognised by its leading `<`).

    Raises:
        LoadError: It cannot be read, or is no XML.
    """
    text = xml_text(source)
    try:
        return ElementTree.parse(source).getroot() if text is None else ElementTree.fromstring(text)
    except (OSError, ElementTree.ParseError, ValueError) as error:
        name = str(source) if text is None else repr(text[:80])
        raise LoadError(f"cannot read robot description {name}: no XML: {error}") from error


def attribute(element: Element, name: str) -> str:
    """An attribute that must be there.

    Raises:
        LoadError: It is not.
    """
    value = element.get(name)
    if value is None:
        raise LoadError(f"<{element.tag}> lacks the attribute {name!r}")
    return value


def numbers(
    element: Element,
    name: str,
    count: int,
    where: str,
    *,
    default: str | None = None,
    positive: bool = False,
) -> FloatArray:
    """Finite numbers in an attribute, (count,).

    Args:
        element: That has the attribute.
        name: Of the attribute.
        count: How many there must be.
        where: The link or joint, for messages.
        default: What a missing attribute stands for; None: it must be there.
        positive: Whether all must be above 0.

    Raises:
        LoadError: They are others.
    """
    text = attribute(element, name) if default is None else element.get(name, default)
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.array([np.nan])
    valid = values.shape == (count,) and bool(np.isfinite(values).all())
    if not valid or (positive and values.min() <= 0):
        kind = "positive numbers" if positive else "numbers" if count > 1 else "number"
        raise LoadError(f"{where}: <{element.tag}> {name}={text!r}, expected {count} {kind}")
    return values


def rotation_of_rpy(rpy: npt.ArrayLike) -> FloatArray:
    """R_z(yaw) R_y(pitch) R_x(roll) of (3,) angles [rad], (3, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def pose_of(element: Element) -> FloatArray:
    """The element's <origin>, (4, 4): of a joint, of geometry or of inertia in its parent's frame.

    Raises:
        LoadError: Its figures are not three numbers each.
    """
    T = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        name = element.get("name")
        where = f"<{element.tag}>" if name is None else f"<{element.tag} name={name!r}>"
        T[:3, :3] = rotation_of_rpy(numbers(origin, "rpy", 3, where, default="0 0 0"))
        T[:3, 3] = numbers(origin, "xyz", 3, where, default="0 0 0")
    return T


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UrdfJoint:
    """A joint of a URDF; its numbers are read when they are asked for."""

    name: str
    type: str  # revolute, continuous, prismatic, fixed, floating or planar
    parent: str  # link
    child: str  # link
    element: Element

    @property
    def T_parent_child(self) -> FloatArray:
        """Pose of the child in the parent at zero, (4, 4)."""
        return pose_of(self.element)

    @property
    def axis(self) -> FloatArray:
        """Unit vector in the child's frame, (3,); x where none is written, as URDF has it."""
        element = self.element.find("axis")
        if element is None:
            return np.array([1.0, 0.0, 0.0])
        vector = numbers(element, "xyz", 3, f"joint {self.name!r}", default="1 0 0")
        return vector / max(float(np.linalg.norm(vector)), 1e-12)

    def limit(self, key: str) -> float | None:
        """An attribute of its <limit>, None without one: lower, upper, effort or velocity.

        Raises:
            LoadError: It is no number.
        """
        element = self.element.find("limit")
        written = None if element is None else element.get(key)
        if written is None:
            return None
        try:
            return float(written)
        except ValueError as error:
            where = f"joint {self.name!r}: limit"
            raise LoadError(f"{where}: {key}={written!r} is no number") from error

    @property
    def leader(self) -> str | None:
        """The joint that it follows, None of one that moves by itself."""
        mimic = self.element.find("mimic")
        return None if mimic is None else mimic.get("joint", "")


def urdf_joints(root: Element) -> Iterator[UrdfJoint]:
    """The joints of a URDF's tree, in the file's order.

    Raises:
        LoadError: One lacks its parent or its child.
    """
    for element in root.findall("joint"):
        parent, child = element.find("parent"), element.find("child")
        if parent is None or child is None:
            raise LoadError(f"joint {element.get('name')!r}: expected <parent> and <child>")
        yield UrdfJoint(
            name=element.get("name", ""),
            type=element.get("type", ""),
            parent=attribute(parent, "link"),
            child=attribute(child, "link"),
            element=element,
        )
