"""The points that stand for an arm: two on each joint axis, and two more that hold the base still.

Maric et al. 2021: p_k is the origin of joint k's frame, q_k a unit further along its axis, and
x, y make of p_0, q_0 a frame. Departs from it in that there is no pair for the tip: it would lie
on the last axis, whose own pair the goal fixes just as well.
"""

import xml.etree.ElementTree as ET

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm

AXIS_LENGTH = 1.0  # |q_k - p_k| [m], as in the public implementation
BASE = (0, 1, 2, 3)  # rows of x, y, p_0, q_0
ON_AXIS = 1e-6  # how far the tip may be off the last axis [m]


class ArmPoints:
    """Rows x, y, p_0, q_0, p_1, q_1, ... of an arm's point matrix, in the base frame [m].

    Raises:
        ValueError: A joint is not revolute, or the tip is not on the last axis, looking along it.
    """

    def __init__(self, arm: Arm) -> None:
        self._robot = arm.robot
        self.n_joints = arm.robot.dof
        self.names = ["x", "y", *(f"{a}{k}" for k in range(self.n_joints) for a in "pq")]
        if bad := set(arm.robot.joint_types) - {"revolute", "continuous"}:
            raise ValueError(f"{arm.name}: expected revolute joints only, got {sorted(bad)}")
        self.links = _moved_links(arm)
        zero = np.zeros(self.n_joints)
        axes = arm.robot.jacobian(zero)[3:].T  # (n, 3)
        self._local_axes = [
            arm.robot.fk(zero, link)[:3, :3].T @ axis
            for link, axis in zip(self.links, axes, strict=True)
        ]
        origin = arm.robot.fk(zero, self.links[0])[:3, 3]
        self._base = origin + AXIS_LENGTH * _base_directions(axes[0])
        T_last_tip = np.linalg.inv(arm.robot.fk(zero, self.links[-1])) @ arm.robot.fk(zero)
        self._tip_offset = float(T_last_tip[:3, 3] @ self._local_axes[-1])
        off = np.linalg.norm(T_last_tip[:3, 3] - self._tip_offset * self._local_axes[-1])
        tilt = np.linalg.norm(T_last_tip[:3, 2] - self._local_axes[-1])
        if max(off, tilt) > ON_AXIS:
            raise ValueError(f"{arm.name}: the tip's z is not the last joint's axis")
        self.zero = self.positions(zero)

    def p(self, joint: int) -> int:
        """Row of a joint's first point; the second follows."""
        return 2 + 2 * joint

    def pair(self, joint: int) -> tuple[int, int]:
        """Rows of both points of a joint; of x and y for joint -1."""
        return 2 + 2 * joint, 3 + 2 * joint

    def positions(self, q: FloatArray) -> FloatArray:
        """All points at q, (2 n + 2, 3) [m]."""
        points = np.empty((2 * self.n_joints + 2, 3))
        points[:4] = self._base
        for joint in range(1, self.n_joints):
            T = self._robot.fk(q, self.links[joint])
            p, q_row = self.pair(joint)
            points[p] = T[:3, 3]
            points[q_row] = T[:3, 3] + AXIS_LENGTH * (T[:3, :3] @ self._local_axes[joint])
        return points

    def goal(self, T_base_tip: FloatArray) -> FloatArray:
        """Where a tip pose puts the last axis's two points, (2, 3) [m]."""
        z = T_base_tip[:3, 2]
        p = T_base_tip[:3, 3] - self._tip_offset * z
        return np.stack([p, p + AXIS_LENGTH * z])


def _moved_links(arm: Arm) -> list[str]:
    """The link behind each joint: its origin is on the joint's axis."""
    joints = {joint.get("name"): joint for joint in ET.parse(arm.urdf).getroot().iter("joint")}
    children = [joints[name].find("child") for name in arm.robot.joint_names]
    return [str(child.get("link")) for child in children if child is not None]


def _base_directions(axis: FloatArray) -> FloatArray:
    """To x, y, p_0, q_0 from the first axis's origin: a right-angled frame, (4, 3)."""
    across = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = across - (across @ axis) * axis
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), np.zeros(3), axis])
