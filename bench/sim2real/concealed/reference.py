"""The believed machine along the commanded motions: what effects are sized against."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.sim2real.concealed.mjcf import Machine, mjcf
from bench.sim2real.frame.arm import Arm, Array
from bench.sim2real.frame.motion import STEP, Motion

EVERY = 40  # rows of a motion between two rows of the reference


class Dynamics:
    """Inverse dynamics of an arm, by MuJoCo."""

    def __init__(self, arm: Arm, armature: Array, gravity: Array | None = None) -> None:
        """A model of the arm with rotors, under the given gravity in its base's axes."""
        machine = Machine.of(armature)
        if gravity is not None:
            machine.gravity = gravity
        self.model = mujoco.MjModel.from_xml_string(mjcf(arm, machine, 1e-3))
        self.data = mujoco.MjData(self.model)
        self._tip = self.model.site("tip").id
        self._still = mujoco.MjData(self.model)

    def torque(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Torques (T, n) of a motion."""
        result = np.empty_like(q)
        model, data = self.model, self.data
        for row in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[row], dq[row], ddq[row]
            mujoco.mj_inverse(model, data)
            result[row] = data.qfrc_inverse
        return result

    def gravity(self, q: Array) -> Array:
        """Torques (n,) that hold one pose."""
        data = self._still
        data.qpos[:] = q
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        result = np.empty(self.model.nv)
        mujoco.mj_rne(self.model, data, 0, result)
        return result

    def mass_matrix(self, q: Array) -> Array:
        """M(q), (n, n), with the rotors on its diagonal."""
        self.data.qpos[:], self.data.qvel[:], self.data.qacc[:] = q, 0.0, 0.0
        mujoco.mj_forward(self.model, self.data)
        full = np.empty((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full

    def tips(self, q: Array) -> tuple[Array, Array]:
        """Positions (T, 3) and rotations (T, 3, 3) of the tip in the base."""
        position, rotation = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
        for row in range(len(q)):
            self.data.qpos[:] = q[row]
            mujoco.mj_kinematics(self.model, self.data)
            position[row] = self.data.site_xpos[self._tip]
            rotation[row] = self.data.site_xmat[self._tip].reshape(3, 3)
        return position, rotation


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """All commanded motions one after the other, thinned."""

    arm: Arm
    armature: Array  # (n,) [kg m^2]
    dynamics: Dynamics
    time: Array  # (T,) since its recording's start [s]
    recording: Array  # (T,) which recording
    q: Array  # (T, n)
    dq: Array  # (T, n)
    ddq: Array  # (T, n)
    tau: Array  # (T, n) of the believed machine [N m]
    inertia: Array  # (n,) M_jj at the middle pose
    lightest: Array  # (n,) 1 / (M^-1)_jj, least over poses


def reference(arm: Arm, armature: Array, motions: Sequence[Motion]) -> Reference:
    """What the believed machine does along the motions."""
    dynamics = Dynamics(arm, armature)
    q, dq, ddq = (
        np.concatenate([getattr(motion, name)[::EVERY] for motion in motions])
        for name in ("q", "dq", "ddq")
    )
    lengths = [len(motion.q[::EVERY]) for motion in motions]
    poses = q[:: max(1, len(q) // 12)]
    masses = [dynamics.mass_matrix(row) for row in poses]
    return Reference(
        arm=arm,
        armature=armature,
        dynamics=dynamics,
        time=np.concatenate([STEP * EVERY * np.arange(length) for length in lengths]),
        recording=np.repeat(np.arange(len(motions)), lengths),
        q=q,
        dq=dq,
        ddq=ddq,
        tau=dynamics.torque(q, dq, ddq),
        inertia=np.mean([np.diag(M) for M in masses], axis=0),
        lightest=np.min([1.0 / np.diag(np.linalg.inv(M)) for M in masses], axis=0),
    )
