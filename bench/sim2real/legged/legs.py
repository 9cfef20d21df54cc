"""Kinematics and weights of the robot as described, for whoever commands it."""

from typing import Any

import mujoco
import numpy as np

from bench.sim2real.legged.machine import as_given
from bench.sim2real.legged.robots import Robot
from bench.sim2real.legged.spec import Array
from bench.sim2real.legged.world import build

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
LIGHT = 1e-3  # weight of a foot in the air; what keeps the feet's sharing solvable


class Legs:
    """The description, moved to where one asks: feet, joints that put them there, torques."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.world = robot, build(as_given(robot))
        self.model: Any = self.world.model
        self.data: Any = mujoco.MjData(self.model)
        nv = self.model.nv
        self.flat = robot.leg_size > 3  # soles that stay flat: their pitch and yaw are asked too
        self._p, self._r = np.zeros((3, nv)), np.zeros((3, nv))
        self._gravity = np.zeros(nv)
        self._com = np.zeros((3, nv))
        self._columns = [self.world.dof[leg] for leg in robot.legs]
        self._lower, self._upper = robot.lower + 1e-3, robot.upper - 1e-3

    def put(self, base: Array, q: Array) -> None:
        """Base pose (7,) and joints (n,)."""
        self.data.qpos[:7] = base
        self.data.qpos[self.world.qpos] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def feet(self) -> Array:
        """Origins of the feet's links where they were put, (feet, 3) [m]."""
        return np.array(self.data.xpos[list(self.world.feet)])

    def com(self) -> Array:
        """Centre of mass of the whole robot, (3,) [m]."""
        return np.array(self.data.subtree_com[self.world.base])

    def turned(self, vector: Array) -> Array:
        """Turns a vector of the base's frame, as it was last put, to the world's, (3,)."""
        return np.asarray(self.data.xmat[self.world.base].reshape(3, 3) @ vector)

    def towards(self, q: Array, targets: Array) -> Array:
        """One Gauss-Newton step of the joints (n,) that brings the feet to targets (feet, 3).

        From where it was last put; flat soles turn level and ahead.
        """
        J, error = self._tasks(targets)
        normal = J.transpose(0, 2, 1) @ J + 1e-8 * np.eye(J.shape[2])
        step = np.linalg.solve(normal, J.transpose(0, 2, 1) @ error[:, :, None])
        q = q.copy()
        q[: step.size] += step.ravel()
        return np.minimum(np.maximum(q, self._lower), self._upper)

    def _tasks(self, targets: Array) -> tuple[Array, Array]:
        """Jacobians (feet, tasks, joints of a leg) and errors (feet, tasks)."""
        size, k = (5, 5) if self.flat else (3, 3)
        J, error = np.empty((len(targets), size, k)), np.empty((len(targets), size))
        for i, (foot, columns) in enumerate(zip(self.world.feet, self._columns, strict=True)):
            position = self.data.xpos[foot]
            mujoco.mj_jac(self.model, self.data, self._p, self._r, position, foot)
            J[i, :3], error[i, :3] = self._p[:, columns], targets[i] - position
            if self.flat:  # of the rotation matrix: small turns about y and z
                R = self.data.xmat[foot]
                J[i, 3:] = self._r[1:, columns]
                error[i, 3:] = -0.5 * (R[2] - R[6]), -0.5 * (R[3] - R[1])
        return J, error

    def solved(self, base: Array, q: Array, targets: Array, steps: int = 3) -> Array:
        """Joints (n,) that have the feet at targets, from a guess."""
        for _ in range(steps):
            self.put(base, q)
            q = self.towards(q, targets)
        self.put(base, q)
        return q

    def torque(self, share: Array, push: Array | None = None) -> Array:
        """What holds the robot still where it was put, (n,) [N m], or (n, 2) of a push's parts.

        Args:
            share: (feet,) how much each foot is to bear of the wrenches of least norm.
            push: with it, the torques that push the centre of mass by 1 N in x and in y.
        """
        joints, size = self.world.dof, 6 if self.flat else 3
        rows = np.zeros((size * len(share), self.model.nv))
        for k, foot in enumerate(self.world.feet):
            mujoco.mj_jac(
                self.model, self.data, self._p, self._r, self.data.xpos[foot] - [0, 0, 0.02], foot
            )
            rows[size * k : size * k + 3] = self._p
            if self.flat:
                rows[size * k + 3 : size * (k + 1)] = self._r
        if push is None:
            mujoco.mj_rne(self.model, self.data, 0, self._gravity)
            load = self._gravity[:, None]
        else:
            mujoco.mj_jacSubtreeCom(self.model, self.data, self._com, self.world.base)
            load = self._com[:2].T
        weight = np.repeat(np.maximum(share, LIGHT), size)[:, None]
        if self.flat:  # moments are dear: the ankles are weak
            weight *= np.tile([1.0, 1.0, 1.0, 0.3, 0.3, 0.3], len(share))[:, None]
        J = rows[:, :6]
        wrench = weight * J @ np.linalg.solve(J.T @ (weight * J) + 1e-4 * np.eye(6), load[:6])
        tau = load[joints] - rows[:, joints].T @ wrench
        return np.asarray(tau[:, 0] if push is None else tau)

    def squeeze(self) -> Array:
        """Torques (n,) by which two feet push the ground apart sideways with 1 N each."""
        tau = np.zeros(self.robot.n)
        for sign, foot in zip((-1.0, 1.0), self.world.feet, strict=True):
            mujoco.mj_jac(self.model, self.data, self._p, self._r, self.data.xpos[foot], foot)
            tau -= sign * self._p[1, self.world.dof]
        return tau

    def gravity(self) -> Array:
        """What holds the joints (n,) [N m] while the base is held."""
        mujoco.mj_rne(self.model, self.data, 0, self._gravity)
        return np.array(self._gravity[self.world.dof])
