"""A robot as a description that every peer reads, and what it must not touch."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

import pdoik
from bench.common.arrays import FloatArray

MARGIN = 1e-4  # that peers are asked to keep: their distances hold to a tolerance [m]
_INERTIA = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}


def by_capsules(name: str) -> pdoik.Robot:
    """A shipped robot without pieces of its links, which peers are not given."""
    robot = pdoik.Robot.builtin(name)
    own = robot.occupancy
    robot.occupancy = pdoik.Occupancy(
        spheres=own.spheres, spheroids=own.spheroids, capsules=own.capsules
    )
    return robot


class Joint(NamedTuple):
    """As the description has it."""

    name: str
    parent: str
    child: str
    xml: Element


class Capsule(NamedTuple):
    """A hull of a link."""

    link: str
    a: FloatArray
    b: FloatArray
    radius: float


@dataclass(frozen=True, kw_only=True)
class Body:
    """A robot in a scene."""

    robot: pdoik.Robot
    urdf: str  # text
    tips: tuple[str, ...]
    self_collision: bool = False
    table: float | None = None  # its top [m]
    points: FloatArray = field(default_factory=lambda: np.empty((0, 3)))

    @cached_property
    def joints(self) -> dict[str, Joint]:
        """Joints by the link that they carry."""
        found = [
            Joint(
                xml.attrib["name"],
                xml.find("parent").attrib["link"],
                xml.find("child").attrib["link"],
                xml,
            )
            for xml in ElementTree.fromstring(self.urdf).iterfind("joint")
        ]
        return {joint.child: joint for joint in found}

    def way_to_root(self, link: str) -> list[Joint]:
        """The joints between a link and the root."""
        way = []
        while link in self.joints:
            way.append(self.joints[link])
            link = way[-1].parent
        return way

    @cached_property
    def moving(self) -> list[str]:
        """The joints that move a tip, as joint_names has them."""
        used = {joint.name for tip in self.tips for joint in self.way_to_root(tip)}
        return [name for name in self.robot.joint_names if name in used]

    @cached_property
    def places(self) -> list[int]:
        """Theirs in q."""
        return [self.robot.joint_names.index(name) for name in self.moving]

    @cached_property
    def root(self) -> str:
        """What `bare` calls it: simulators keep the name `world` for themselves."""
        return self.bare_name(self.robot.link_names[0])

    def bare_name(self, link: str) -> str:
        """Name of a link in `bare`."""
        return "root_link" if link == "world" else link

    @cached_property
    def bare(self) -> str:
        """The body's kinematics and limits as URDF; joints that move no tip are fixed."""
        xml = Element("robot", name="body")
        for link in ElementTree.fromstring(self.urdf).iterfind("link"):
            added = SubElement(xml, "link", name=self.bare_name(link.attrib["name"]))
            inertial = SubElement(added, "inertial")
            SubElement(inertial, "mass", value="1")
            SubElement(inertial, "inertia", _INERTIA)
        for joint in self.joints.values():
            moves = joint.name in self.moving
            added = SubElement(xml, "joint", name=joint.name, type="revolute" if moves else "fixed")
            added.extend(each for each in joint.xml if each.tag in ("origin", "axis"))
            SubElement(added, "parent", link=self.bare_name(joint.parent))
            SubElement(added, "child", link=self.bare_name(joint.child))
            if moves:
                k = self.robot.joint_names.index(joint.name)
                ends = {end: repr(float(getattr(self.robot, end)[k])) for end in ("lower", "upper")}
                SubElement(added, "limit", {**ends, "effort": "1", "velocity": "10"})
        return ElementTree.tostring(xml, encoding="unicode")

    @property
    def has_contacts(self) -> bool:
        """Whether there is anything to touch."""
        return self.self_collision or self.table is not None or len(self.points) > 0

    @cached_property
    def capsules(self) -> list[Capsule]:
        """The body's hulls."""
        return [
            Capsule(link, np.array(a), np.array(b), radius)
            for link, a, b, radius, *_ in self.robot.occupancy.capsules
        ]

    @cached_property
    def still(self) -> set[str]:
        """Links that no joint moves."""
        moved = set(self.robot.joint_names)
        return {
            link
            for link in self.robot.link_names
            if not moved & {joint.name for joint in self.way_to_root(link)}
        }

    @cached_property
    def apart(self) -> list[tuple[str, str]]:
        """Pairs of links that must not touch: not joined, not both still, and not ignored."""
        links = list(dict.fromkeys(capsule.link for capsule in self.capsules))
        joined = [(joint.parent, joint.child) for joint in self.joints.values()]
        near = {frozenset(pair) for pair in [*joined, *self.robot.ignored_pairs]}
        return [
            (one, other)
            for k, one in enumerate(links)
            for other in links[k + 1 :]
            if self.self_collision
            and frozenset((one, other)) not in near
            and not {one, other} <= self.still
        ]
