"""The robot's figures, from the shipped h1.urdf."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

URDF = Path(str(files("pdoik"))) / "robots" / "h1.urdf"
OCCUPANCY = URDF.with_name("h1.occupancy.yaml")
ROOT_LINK = "pelvis"
BASE_LINK = "left_ankle_link"  # the solver's base
TIP_LINK = "right_ankle_link"  # the solver's end effector
FEET = (BASE_LINK, TIP_LINK)

_LEG = ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle")
_ARM = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow")

JOINT_NAMES: tuple[str, ...] = (
    *(f"left_{part}_joint" for part in reversed(_LEG)),
    *(f"right_{part}_joint" for part in _LEG),
    "torso_joint",
    *(f"left_{part}_joint" for part in _ARM),
    *(f"right_{part}_joint" for part in _ARM),
)
"""The order of every (19,) vector: depth first from the left ankle, as pdoik.Robot has it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """A rigid body, in its own frame, which is that of its joint."""

    name: str
    mass: float  # [kg]
    center: tuple[float, ...]  # of mass, (3,) [m]
    inertia: tuple[float, ...]  # about `center`: xx, yy, zz, xy, xz, yz [kg m^2]


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A revolute joint; its frame and the child link's are one."""

    name: str
    parent: str
    child: str
    xyz: tuple[float, ...]  # of the joint's frame in the parent's, (3,) [m]
    rpy: tuple[float, ...]  # (3,) [rad]: R = Rz(yaw) Ry(pitch) Rx(roll)
    axis: tuple[float, ...]  # (3,)
    lower: float  # [rad]
    upper: float  # [rad]
    effort: float  # [N m]
    velocity: float  # [rad/s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """The tree: parents before children, as the URDF lists them."""

    links: dict[str, Link]
    joints: dict[str, Joint]

    @property
    def mass(self) -> float:
        """Of the whole robot, [kg]."""
        return sum(link.mass for link in self.links.values())

    def per_joint(self, name: str) -> FloatArray:
        """One of Joint's numbers, (19,) in the order of JOINT_NAMES."""
        return np.array([getattr(self.joints[joint], name) for joint in JOINT_NAMES], dtype=float)


@cache
def figures() -> Figures:
    """What h1.urdf says."""
    root = ElementTree.parse(URDF).getroot()
    links = [_read_link(element) for element in root.findall("link")]
    joints = [_read_joint(element) for element in root.findall("joint")]
    return Figures(
        links={link.name: link for link in links}, joints={joint.name: joint for joint in joints}
    )


def _read_link(element: ElementTree.Element) -> Link:
    inertia = _child(element, "inertial/inertia")
    return Link(
        name=element.attrib["name"],
        mass=float(_child(element, "inertial/mass").attrib["value"]),
        center=_triple(_child(element, "inertial/origin").attrib["xyz"]),
        inertia=tuple(
            float(inertia.attrib[key]) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        ),
    )


def _read_joint(element: ElementTree.Element) -> Joint:
    origin, limit = _child(element, "origin"), _child(element, "limit")
    return Joint(
        name=element.attrib["name"],
        parent=_child(element, "parent").attrib["link"],
        child=_child(element, "child").attrib["link"],
        xyz=_triple(origin.attrib["xyz"]),
        rpy=_triple(origin.get("rpy", "0 0 0")),
        axis=_triple(_child(element, "axis").attrib["xyz"]),
        lower=float(limit.attrib["lower"]),
        upper=float(limit.attrib["upper"]),
        effort=float(limit.attrib["effort"]),
        velocity=float(limit.attrib["velocity"]),
    )


def _child(element: ElementTree.Element, path: str) -> ElementTree.Element:
    found = element.find(path)
    if found is None:
        raise ValueError(f"{URDF}: {element.get('name')!r} lacks <{path}>")
    return found


def _triple(text: str) -> tuple[float, ...]:
    return tuple(float(word) for word in text.split())
