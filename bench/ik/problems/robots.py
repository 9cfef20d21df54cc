"""The robots of the problem sets: their published descriptions, tips, and joints that are held.

Panda with hand, UR5 with gripper, UR10 and Unitree G1 come from the Python package
example-robot-data. Fetch is in no package: give its files (`RobotFiles.of`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import numpy as np

from bench.ik.judges.arm_meshes import _example_robot_data_share

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
    held: Mapping[str, float] = field(default_factory=dict)  # joints that stand still [rad], [m]
    touch_links: tuple[str, ...] = ()  # the tool's links, which may touch what carries a target

    def xml(self, hull_meshes: Meshes = "collision") -> str:
        """The URDF with its held joints fixed where they stand, as text.

        Args:
            hull_meshes: "visual" puts each link's visual geometry in place of its collision
                geometry, for what reads only the latter.

        Raises:
            ValueError: A held joint is not in the description.
        """
        root = ElementTree.parse(self.urdf).getroot()
        joints = {joint.get("name"): joint for joint in root.findall("joint")}
        for name, value in self.held.items():
            if name not in joints:
                raise ValueError(f"{self.urdf}: no joint {name!r} to hold")
            _fix(joints[name], value)
        for extra in ("transmission", "gazebo"):
            for element in root.findall(extra):
                root.remove(element)
        if hull_meshes == "visual":
            for link in root.findall("link"):
                _show_as_collision(link)
        return ElementTree.tostring(root, encoding="unicode")


def robot_files(name: str) -> RobotFiles:
    """The robot of this name.

    Raises:
        ValueError: There is none.
        MissingDescriptionError: The package with its description is not installed.
    """
    if name not in _ROBOTS:
        raise ValueError(f"robot {name!r} is not one of {sorted(_ROBOTS)}")
    return _ROBOTS[name]()


def _fix(joint: ElementTree.Element, value: float) -> None:
    """Make a joint fixed, its origin moved by what the joint stands at."""
    from scipy.spatial.transform import Rotation

    origin = joint.find("origin")
    if origin is None:
        origin = ElementTree.SubElement(joint, "origin")
    rpy = [float(word) for word in origin.get("rpy", "0 0 0").split()]
    xyz = np.array([float(word) for word in origin.get("xyz", "0 0 0").split()])
    element = joint.find("axis")
    axis = np.array([1.0, 0, 0])
    if element is not None:
        axis = np.array([float(word) for word in element.get("xyz", "1 0 0").split()])
    R = Rotation.from_euler("xyz", rpy)
    if joint.get("type") == "prismatic":
        xyz = xyz + R.apply(value * axis)
    else:
        R = R * Rotation.from_rotvec(value * axis)
    origin.set("xyz", " ".join(f"{number:.12g}" for number in xyz))
    origin.set("rpy", " ".join(f"{number:.12g}" for number in R.as_euler("xyz")))
    joint.set("type", "fixed")
    for tag in ("axis", "limit", "mimic", "dynamics", "safety_controller", "calibration"):
        for child in joint.findall(tag):
            joint.remove(child)


def _show_as_collision(link: ElementTree.Element) -> None:
    visuals = link.findall("visual")
    if not visuals:
        return
    for collision in link.findall("collision"):
        link.remove(collision)
    for visual in visuals:
        copy = ElementTree.SubElement(link, "collision")
        copy.extend(child for child in visual if child.tag in ("origin", "geometry"))


def _panda() -> RobotFiles:
    share = _example_robot_data_share()
    folder = share / "example-robot-data/robots/panda_description"
    return RobotFiles(
        name="panda",
        urdf=folder / "urdf/panda.urdf",
        srdf=folder / "srdf/panda.srdf",
        package_dirs=(share,),
        tips=("panda_hand_tcp",),
        held={"panda_finger_joint1": 0.04, "panda_finger_joint2": 0.04},
        touch_links=("panda_hand", "panda_leftfinger", "panda_rightfinger"),
    )


def _ur5() -> RobotFiles:
    share = _example_robot_data_share()
    folder = share / "example-robot-data/robots/ur_description"
    return RobotFiles(
        name="ur5",
        urdf=folder / "urdf/ur5_gripper.urdf",
        srdf=folder / "srdf/ur5_gripper.srdf",
        package_dirs=(share,),
        tips=("ee_link",),
        base="base_link",
        touch_links=("wrist_3_link", "ee_link", "tool0"),
    )


def _ur10() -> RobotFiles:
    share = _example_robot_data_share()
    folder = share / "example-robot-data/robots/ur_description"
    return RobotFiles(
        name="ur10",
        urdf=folder / "urdf/ur10_robot.urdf",
        srdf=None,
        package_dirs=(share,),
        tips=("tool0",),
        base="base_link",
        touch_links=("wrist_3_link", "ee_link", "tool0"),
    )


def _g1() -> RobotFiles:
    """Unitree's G1 on its left foot, hands open and still."""
    share = _example_robot_data_share()
    folder = share / "example-robot-data/robots/g1_description"
    fingers = ("index_0", "index_1", "middle_0", "middle_1", "thumb_0", "thumb_1", "thumb_2")
    return RobotFiles(
        name="g1",
        urdf=folder / "urdf/g1_29dof_with_hand_rev_1_0.urdf",
        srdf=None,
        package_dirs=(folder / "urdf", share),
        tips=("right_ankle_roll_link", "left_hand_palm_link", "right_hand_palm_link"),
        base="left_ankle_roll_link",
        held={f"{side}_hand_{f}_joint": 0.0 for side in ("left", "right") for f in fingers},
    )


_ROBOTS = {"panda": _panda, "ur5": _ur5, "ur10": _ur10, "g1": _g1}
