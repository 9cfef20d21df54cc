"""A serial arm as plain figures: read from a URDF, written as one."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """A rigid body in the axes of its joint's frame."""

    mass: float  # [kg]
    com: Array  # (3,) [m]
    inertia: Array  # (3, 3) about com [kg m^2]

    def plus(self, other: Link) -> Link:
        """This body with another one fixed to it."""
        mass = self.mass + other.mass
        com = (self.mass * self.com + other.mass * other.com) / mass
        inertia = self.about(com) + other.about(com)
        return Link(mass=mass, com=com, inertia=inertia)

    def about(self, point: Array) -> Array:
        """Inertia about a point, by the parallel axis theorem."""
        r = self.com - point
        return self.inertia + self.mass * (r @ r * np.eye(3) - np.outer(r, r))

    def moved(self, T: Array) -> Link:
        """The same body in the axes of a frame in which this one's frame has the pose T."""
        R = T[:3, :3]
        return Link(mass=self.mass, com=R @ self.com + T[:3, 3], inertia=R @ self.inertia @ R.T)


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A hinge, placed in its parent link."""

    T_parent_joint: Array  # (4, 4) at position zero
    axis: Array  # (3,) unit, in the joint's frame
    lower: float  # [rad]
    upper: float  # [rad]
    effort: float  # [N m]
    speed: float  # [rad/s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """Hinges and links from a fixed base to a tip."""

    joints: tuple[Joint, ...]
    links: tuple[Link, ...]  # one per joint
    T_last_tip: Array  # (4, 4)

    @property
    def n(self) -> int:
        return len(self.joints)

    @property
    def efforts(self) -> Array:
        return np.array([joint.effort for joint in self.joints])

    @property
    def speeds(self) -> Array:
        return np.array([joint.speed for joint in self.joints])

    @property
    def limits(self) -> tuple[Array, Array]:
        """Lower and upper, (n,) each [rad]."""
        return np.array([j.lower for j in self.joints]), np.array([j.upper for j in self.joints])

    def with_link(self, index: int, link: Link) -> Arm:
        links = list(self.links)
        links[index] = link
        return replace(self, links=tuple(links))

    def with_placement(self, index: int, T: Array) -> Arm:
        """The arm with one joint placed elsewhere."""
        joints = list(self.joints)
        joints[index] = replace(joints[index], T_parent_joint=T)
        return replace(self, joints=tuple(joints))


def rotation_rpy(rpy: Array) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(R: Array) -> Array:
    """The roll, pitch and yaw of a rotation."""
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    if np.hypot(R[0, 0], R[1, 0]) < 1e-9:
        return np.array([np.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    return np.array([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])


def pose(xyz: Array, rpy: Array) -> Array:
    """A 4x4 pose from a URDF's figures."""
    T = np.eye(4)
    T[:3, :3] = rotation_rpy(np.asarray(rpy, float))
    T[:3, 3] = xyz
    return T


def quaternion(R: Array) -> Array:
    """The quaternion (w, x, y, z) of a rotation, w >= 0."""
    K = np.array(
        [
            [R[0, 0] + R[1, 1] + R[2, 2], 0, 0, 0],
            [R[2, 1] - R[1, 2], R[0, 0] - R[1, 1] - R[2, 2], 0, 0],
            [R[0, 2] - R[2, 0], R[1, 0] + R[0, 1], R[1, 1] - R[0, 0] - R[2, 2], 0],
            [R[1, 0] - R[0, 1], R[2, 0] + R[0, 2], R[2, 1] + R[1, 2], R[2, 2] - R[0, 0] - R[1, 1]],
        ]
    )
    vector = np.linalg.eigh(K / 3.0)[1][:, -1]  # eigh reads the lower triangle
    return vector if vector[0] >= 0 else -vector


def _vector(element: ET.Element | None, name: str, default: str) -> Array:
    text = default if element is None else element.get(name, default)
    return np.array([float(word) for word in text.split()])


def _link_of(element: ET.Element) -> Link | None:
    inertial = element.find("inertial")
    if inertial is None:
        return None
    origin, tensor = inertial.find("origin"), inertial.find("inertia").attrib
    xx, yy, zz, xy, xz, yz = (float(tensor[k]) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    T = pose(_vector(origin, "xyz", "0 0 0"), _vector(origin, "rpy", "0 0 0"))
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    mass = float(inertial.find("mass").get("value"))
    return Link(mass=mass, com=np.zeros(3), inertia=matrix).moved(T)


def read_chain(path: Path, base: str, tip: str) -> Arm:
    """The chain of hinges between two links of a URDF; fixed joints are folded into the links."""
    root = ET.parse(path).getroot()
    links = {link.get("name"): _link_of(link) for link in root.findall("link")}
    by_child = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    elements = []
    name = tip
    while name != base:
        elements.insert(0, by_child[name])
        name = elements[0].find("parent").get("link")
    T, joints, bodies = np.eye(4), [], []
    for element in elements:
        origin = element.find("origin")
        T = T @ pose(_vector(origin, "xyz", "0 0 0"), _vector(origin, "rpy", "0 0 0"))
        body = links[element.find("child").get("link")]
        if element.get("type") == "fixed":
            if body is not None and bodies:
                bodies[-1] = bodies[-1].plus(body.moved(T))
            continue
        limit, axis = element.find("limit"), _vector(element.find("axis"), "xyz", "1 0 0")
        joints.append(
            Joint(
                T_parent_joint=T,
                axis=axis / np.linalg.norm(axis),
                lower=float(limit.get("lower")),
                upper=float(limit.get("upper")),
                effort=float(limit.get("effort")),
                speed=float(limit.get("velocity")),
            )
        )
        bodies.append(body)
        T = np.eye(4)
    return Arm(joints=tuple(joints), links=tuple(bodies), T_last_tip=T)


def words(values: Array) -> str:
    return " ".join(f"{float(value):.9g}" for value in np.asarray(values).ravel())


def urdf(arm: Arm) -> str:
    """The arm as a URDF: joint1 .. jointN, base, link1 .. linkN, tool; nothing to look at."""
    lines = ['<?xml version="1.0"?>', '<robot name="arm">', '  <link name="base"/>']
    for index, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True), start=1):
        J, T = link.inertia, joint.T_parent_joint
        parent = "base" if index == 1 else f"link{index - 1}"
        lines += [
            f'  <link name="link{index}">',
            "    <inertial>",
            f'      <origin xyz="{words(link.com)}" rpy="0 0 0"/>',
            f'      <mass value="{link.mass:.9g}"/>',
            f'      <inertia ixx="{J[0, 0]:.9g}" ixy="{J[0, 1]:.9g}" ixz="{J[0, 2]:.9g}"'
            f' iyy="{J[1, 1]:.9g}" iyz="{J[1, 2]:.9g}" izz="{J[2, 2]:.9g}"/>',
            "    </inertial>",
            "  </link>",
            f'  <joint name="joint{index}" type="revolute">',
            f'    <parent link="{parent}"/>',
            f'    <child link="link{index}"/>',
            f'    <origin xyz="{words(T[:3, 3])}" rpy="{words(rpy_of(T[:3, :3]))}"/>',
            f'    <axis xyz="{words(joint.axis)}"/>',
            f'    <limit lower="{joint.lower:.6g}" upper="{joint.upper:.6g}"'
            f' effort="{joint.effort:.6g}" velocity="{joint.speed:.6g}"/>',
            "  </joint>",
        ]
    T = arm.T_last_tip
    lines += [
        '  <link name="tool"/>',
        '  <joint name="tool_joint" type="fixed">',
        f'    <parent link="link{arm.n}"/>',
        '    <child link="tool"/>',
        f'    <origin xyz="{words(T[:3, 3])}" rpy="{words(rpy_of(T[:3, :3]))}"/>',
        "  </joint>",
        "</robot>",
    ]
    return "\n".join(lines) + "\n"
