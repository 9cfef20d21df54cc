"""The robots of the problem sets: their published descriptions, tips, and joints that are held.

Panda with hand, UR5 with gripper, UR10 and Unitree G1 come from the Python package
example-robot-data. Fetch is in no package: give its files.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.common.descriptions import example_robot_data

Meshes = Literal["visual", "collision"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFiles:
    """A description and how the benchmark uses it."""

    name: str
    urdf: Path
    srdf: Path | None
    package_dirs: tuple[Path, ...]
    tips: tuple[str, ...]
    base: str | None = None  # None for the description's root
    held: Mapping[str, float] = field(default_factory=dict)
    """Joints that stand still [rad], [m], unless other values are given."""
    told: Mapping[str, float] = field(default_factory=dict)
    """The same, as the user or a problem says."""
    touch_links: tuple[str, ...] = ()  # the tool's links, which may touch what carries a target

    @property
    def still(self) -> dict[str, float]:
        """All joints that stand still."""
        return {**self.held, **self.told}

    def standing(self, values: Mapping[str, float], moved: Collection[str]) -> "RobotFiles":
        """With joints that are not moved where these values say, unless they were given before.

        Joints that the description does not have are left out; what follows another one follows.
        """
        still = {}
        for name, joint in self._movable().items():
            mimic = joint.find("mimic")
            leader = "" if mimic is None else mimic.get("joint", "")
            if name in moved:
                continue
            if name in values:
                still[name] = values[name]
            elif mimic is not None and leader in values:
                factor = float(mimic.get("multiplier", 1))
                still[name] = factor * values[leader] + float(mimic.get("offset", 0))
        return replace(self, told={**still, **self.told})

    def _movable(self) -> dict[str, ElementTree.Element]:
        joints = ElementTree.parse(self.urdf).getroot().findall("joint")
        return {str(each.get("name")): each for each in joints if each.get("type") != "fixed"}

    def xml(self, hull_meshes: Meshes = "collision") -> str:
        """The URDF with its held joints fixed where they stand, as text.

        "visual" puts each link's visual geometry in place of its collision geometry, for what
        reads only the latter.

        Raises:
            ValueError: A held joint is not in the description.
        """
        root = ElementTree.parse(self.urdf).getroot()
        joints = {joint.get("name"): joint for joint in root.findall("joint")}
        for name, value in self.still.items():
            if name not in joints:
                raise ValueError(f"{self.urdf}: no joint {name!r} to hold")
            _fix(joints[name], value)
        _remove(root, "transmission", "gazebo")
        for link in root.findall("link") if hull_meshes == "visual" else ():
            if visuals := link.findall("visual"):
                _remove(link, "collision")
                for visual in visuals:
                    copy = ElementTree.SubElement(link, "collision")
                    copy.extend(child for child in visual if child.tag in ("origin", "geometry"))
        return ElementTree.tostring(root, encoding="unicode")


def _fix(joint: ElementTree.Element, value: float) -> None:
    """Make a joint fixed, its origin moved by what the joint stands at."""
    origin = joint.find("origin")
    if origin is None:
        origin = ElementTree.SubElement(joint, "origin")
    axis = _numbers(joint.find("axis"), "xyz", "1 0 0")
    xyz = _numbers(origin, "xyz", "0 0 0")
    R = Rotation.from_euler("xyz", _numbers(origin, "rpy", "0 0 0"))
    if joint.get("type") == "prismatic":
        xyz = xyz + R.apply(value * axis)
    else:
        R = R * Rotation.from_rotvec(value * axis)
    origin.set("xyz", " ".join(f"{number:.12g}" for number in xyz))
    origin.set("rpy", " ".join(f"{number:.12g}" for number in R.as_euler("xyz")))
    joint.set("type", "fixed")
    _remove(joint, "axis", "limit", "mimic", "dynamics", "safety_controller", "calibration")


def _numbers(element: ElementTree.Element | None, name: str, default: str) -> FloatArray:
    text = default if element is None else element.get(name, default)
    return np.array([float(word) for word in text.split()])


def _remove(element: ElementTree.Element, *tags: str) -> None:
    for tag in tags:
        for child in element.findall(tag):
            element.remove(child)


def robot_files(name: str) -> RobotFiles:
    """The robot of this name.

    Raises:
        ValueError: There is none.
        MissingDescriptionError: The package with its description is not installed.
    """
    share = example_robot_data()
    robots = share / "example-robot-data/robots"
    ur, g1 = robots / "ur_description", robots / "g1_description/urdf"
    wrist = ("wrist_3_link", "ee_link", "tool0")
    fingers = ("index_0", "index_1", "middle_0", "middle_1", "thumb_0", "thumb_1", "thumb_2")
    known = {
        "panda": {
            "urdf": robots / "panda_description/urdf/panda.urdf",
            "srdf": robots / "panda_description/srdf/panda.srdf",
            "tips": ("panda_hand_tcp",),
            "held": {"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04},
            "touch_links": ("panda_hand", "panda_leftfinger", "panda_rightfinger"),
        },
        "ur5": {
            "urdf": ur / "urdf/ur5_gripper.urdf",
            "srdf": ur / "srdf/ur5_gripper.srdf",
            "tips": ("ee_link",),
            "base": "base_link",
            "touch_links": wrist,
        },
        "ur10": {
            "urdf": ur / "urdf/ur10_robot.urdf",
            "tips": ("tool0",),
            "base": "base_link",
            "touch_links": wrist,
        },
        "g1": {  # on its left foot, hands open and still
            "urdf": g1 / "g1_29dof_with_hand_rev_1_0.urdf",
            "package_dirs": (g1, share),
            "tips": ("right_ankle_roll_link", "left_hand_palm_link", "right_hand_palm_link"),
            "base": "left_ankle_roll_link",
            "held": {f"{side}_hand_{f}_joint": 0.0 for side in ("left", "right") for f in fingers},
        },
    }
    if name not in known:
        raise ValueError(f"robot {name!r} is not one of {sorted(known)}")
    return RobotFiles(**{"name": name, "srdf": None, "package_dirs": (share,), **known[name]})
