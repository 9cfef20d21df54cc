"""Where a robot's links are, from its description alone, without the compiled library."""

from __future__ import annotations

import numpy as np

from .._core import Robot
from .robot import JOINT_TYPES
from .values import FloatArray


class Kinematics:
    """Plain products of matrices along the tree of a description's joints.

    Args:
        robot: Its description is taken, and the order of its joints in q.
    """

    def __init__(self, robot: Robot) -> None:
        _, _, joints, self._base, *_ = robot.__getstate__()
        self._place = {name: k for k, name in enumerate(robot.joint_names)}
        self._joints = {joint[0]: joint for joint in joints}
        to = {joint[3]: joint for joint in joints}
        self._roots = {joint[2] for joint in joints} - set(to) or {self._base}
        self._order = []  # joints, each after that which moves its parent link
        placed = set(self._roots)
        while len(placed) < len(self._roots) + len(to):
            new = [joint for link, joint in to.items() if link not in placed and joint[2] in placed]
            self._order += new
            placed |= {joint[3] for joint in new}

    def position(self, name: str, q: FloatArray) -> float:
        """Position of a joint [rad] or [m]; one that follows another is moved by it."""
        mimic = self._joints[name][10]
        if mimic is None:
            return float(q[self._place[name]])
        leader, multiplier, offset = mimic
        return float(multiplier * self.position(leader, q) + offset)

    def poses(self, q: FloatArray) -> dict[str, FloatArray]:
        """T_base_link of every link, (4, 4) [m]."""
        T_root = dict.fromkeys(self._roots, np.eye(4))
        for name, kind, parent, child, T_parent_child, axis, *_ in self._order:
            T = T_root[parent] @ T_parent_child
            if JOINT_TYPES[kind] != "fixed":
                T = T @ _motion(JOINT_TYPES[kind], axis, self.position(name, q))
            T_root[child] = T
        base = np.linalg.inv(T_root[self._base])
        return {link: base @ T for link, T in T_root.items()}

    def limit_violation(self, q: FloatArray) -> float:
        """The largest over joints, those that follow others included [rad] or [m]."""
        if not np.isfinite(q).all():
            return np.inf
        worst = 0.0
        for name, kind, *rest in self._joints.values():
            if JOINT_TYPES[kind] not in ("revolute", "prismatic"):
                continue
            lower, upper, mimic = rest[4], rest[5], rest[8]
            x = self.position(name, q)
            rounding = 0.0 if mimic is None else 1e-12 * (1.0 + abs(x))
            worst = max(worst, lower - x - rounding, x - upper - rounding)
        return worst


def _motion(kind: str, axis: FloatArray, x: float) -> FloatArray:
    T = np.eye(4)
    axis = axis / np.linalg.norm(axis)
    if kind == "prismatic":
        T[:3, 3] = x * axis
        return T
    a, b, c = axis
    K = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
    T[:3, :3] += np.sin(x) * K + (1.0 - np.cos(x)) * (K @ K)  # Rodrigues
    return T
