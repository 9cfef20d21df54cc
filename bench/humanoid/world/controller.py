"""Joint torques that follow a posture: PD, and what gravity asks of a robot on two feet."""

from __future__ import annotations

import mujoco
import numpy as np

from bench.common.arrays import FloatArray
from bench.humanoid.world.model import World
from bench.humanoid.world.robot import robot_in_world
from pdoik.view.h1_shapes import JOINT_NAMES

GAINS: dict[str, tuple[float, float]] = {  # stiffness [N m/rad], damping [N m s/rad]
    "hip": (1000, 30),
    "knee": (1000, 30),
    "ankle": (400, 15),
    "torso": (500, 20),
    "shoulder": (200, 8),
    "elbow": (100, 4),
}
VELOCITY_SMOOTHING = 0.01  # time constant of the commanded velocity, [s]
COM_GAINS = (1500.0, 300.0)  # [N/m], [N s/m]
FADE = 0.1  # over this share of a joint's speed limit its driving torque fades to zero
GRAVITY = 9.81  # [m/s^2]


def _gain(joint: str) -> tuple[float, float]:
    return next(gain for part, gain in GAINS.items() if part in joint)


class Controller:
    """Follows desired joint positions within the motors' torques and the joints' speeds.

    The command moves towards what is desired no faster than the joints may turn. Then

        tau = kp (q_cmd - q) + kd (dq_cmd - dq) + tau_gravity,    |tau| <= effort

    with dq_cmd smoothed, since a solver's answers come in steps; near a joint's speed limit the
    torque that would drive it faster fades out, as a motor's does. tau_gravity holds the robot
    still on its feet: of all foot wrenches w that carry its weight at the floating base, J_b^T w =
    g_b, it takes those of least norm, and tau_gravity = g_j - J_j^T w. A foot on a ball carries
    a force only.

    With the set-up's com_feedback a horizontal force F = k (c_cmd - c) + d (dc_cmd - dc) at the
    centre of mass is carried to the feet in the same way, c_cmd being where the commanded posture
    has it: ankles alone are about as stiff as gravity is strong.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._robot = robot_in_world(world.setup)
        self._kp, self._kd = np.array([_gain(name) for name in JOINT_NAMES], dtype=float).T
        self._velocity = self._robot.velocity  # (19,) [rad/s]
        self._step = self._velocity * world.model.opt.timestep
        self._rate = world.model.opt.timestep / VELOCITY_SMOOTHING
        self._com = np.zeros((3, world.model.nv))
        n_right = 3 if world.setup.feet == "weld and ball" else 6
        self._feet = np.zeros((6 + n_right, world.model.nv))  # J: twists of the feet
        self._weight = float(world.model.body_subtreemass[world.root]) * GRAVITY
        self._q_command = np.zeros(len(JOINT_NAMES))
        self._dq_command = np.zeros(len(JOINT_NAMES))

    def reset(self, q: FloatArray) -> None:
        """Start from rest in posture q (19,)."""
        self._q_command[:] = q
        self._dq_command[:] = 0

    def gravity_torque(self, data: mujoco.MjData, with_feedback: bool = False) -> FloatArray:
        """What holds the present posture on its feet, (19,) [N m]; may exceed the efforts.

        Needs the positions' part of mj_step (mj_step1). With feedback, what carries the force on
        the centre of mass is in it.
        """
        model, world = self._world.model, self._world
        mujoco.mj_jacSubtreeCom(model, data, self._com, world.root)
        left, right = world.feet
        mujoco.mj_jacBody(model, data, self._feet[:3], self._feet[3:6], left)
        rotation = self._feet[9:] if len(self._feet) == 12 else None
        mujoco.mj_jacBody(model, data, self._feet[6:9], rotation, right)
        g = self._weight * self._com[2]
        if with_feedback:
            g = g + self._com_force(data) @ self._com[:2]
        J_base = self._feet[:, :6]  # the floating base's six are the first
        wrench = J_base @ np.linalg.solve(J_base.T @ J_base, g[:6])  # least norm
        joints = world.dof_index
        return np.asarray(g[joints] - wrench @ self._feet[:, joints])

    def _com_force(self, data: mujoco.MjData) -> FloatArray:
        """Horizontal, on the centre of mass, (2,) [N]."""
        stiffness, damping = COM_GAINS
        wanted = self._robot.center_of_mass(self._q_command)[:2]
        velocity = (self._robot.center_of_mass_jacobian(self._q_command) @ self._dq_command)[:2]
        off = wanted - data.subtree_com[self._world.root][:2]
        return np.asarray(stiffness * off + damping * (velocity - self._com[:2] @ data.qvel))

    def torque(self, data: mujoco.MjData, q_desired: FloatArray) -> FloatArray:
        """One step's torques towards q_desired (19,), clipped to the efforts, (19,) [N m]."""
        step = np.clip(q_desired - self._q_command, -self._step, self._step)
        self._q_command += step
        self._dq_command += self._rate * (step / self._world.model.opt.timestep - self._dq_command)
        q = data.qpos[self._world.qpos_index]
        dq = data.qvel[self._world.dof_index]
        tau = self._kp * (self._q_command - q) + self._kd * (self._dq_command - dq)
        tau += self.gravity_torque(data, self._world.setup.com_feedback)
        spare = np.clip((self._velocity - np.abs(dq)) / (FADE * self._velocity), 0.0, 1.0)
        limit = np.where(tau * dq > 0, spare, 1.0) * self._world.effort
        return np.asarray(np.clip(tau, -limit, limit))
