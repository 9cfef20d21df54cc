"""One machine moving: controller ticks, physics steps between them, what is true at each tick."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.equipment import Controller, Sensors
from bench.sim2real.concealed.mjcf import Machine, mjcf
from bench.sim2real.concealed.reference import Dynamics
from bench.sim2real.frame.arm import Arm, Array
from bench.sim2real.frame.motion import Motion

TIMESTEP = 5e-4  # of the physics [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """Rows at the controller's ticks, nothing measured except what the controller itself read."""

    time: Array  # (K,)
    q: Array  # (K, n) motor side, as the encoders would say without error
    dq: Array  # (K, n)
    tau: Array  # (K, n) exerted, mean over the tick that follows
    tau_cmd: Array  # (K, n)
    q_read: Array  # (K, n) with quantisation and noise
    dq_read: Array  # (K, n)
    q_des: Array  # (K, n) as sent
    dq_des: Array  # (K, n)
    qpos: Array  # (K, nq) of MuJoCo


class Run:
    """One recording's simulation; effects hold on to its arrays."""

    def __init__(
        self, world: World, motion: Motion, recording: int, rng: np.random.Generator
    ) -> None:
        """Set the machine at rest at the motion's first row."""
        self.world, self.motion, self.recording, self.rng = world, motion, recording, rng
        self.model, self.data = world.model, mujoco.MjData(world.model)
        self.qpos, self.qvel, self.qacc = self.data.qpos, self.data.qvel, self.data.qacc
        self.applied = self.data.qfrc_applied
        self.motor = world.motor
        self.exerted = np.zeros(world.arm.n)
        self.qpos[self.motor] = world.joints_of_motors(motion.q[0])
        load = world.believed.gravity(motion.q[0])
        for effect in world.effects:
            rest = getattr(effect, "rest", None)
            if rest is not None:
                hinge = self.model.joint(f"s{effect.joint}").qposadr[0]
                self.qpos[hinge] = rest(load[effect.joint])
        mujoco.mj_forward(self.model, self.data)

    def simulate(self) -> Truth:
        world, data, model = self.world, self.data, self.model
        control, sensors = world.control, world.sensors
        n = world.arm.n
        stride = round(control.period / 1e-3)
        time = self.motion.time[::stride]
        q_des, dq_des = self.motion.q[::stride], self.motion.dq[::stride]
        if not control.knows_speed:
            dq_des = np.zeros_like(dq_des)
        q_in, dq_in = q_des, dq_des
        for effect in world.effects:
            q_in, dq_in = effect.change_command(time, q_in, dq_in)
        count = len(time)
        laws = [law for effect in world.effects if (law := effect.step_law(self)) is not None]
        drives = [drive for effect in world.effects if (drive := effect.drive(self)) is not None]
        substeps = round(control.period / TIMESTEP)
        q_noise = self.rng.normal(0.0, 1.0, (count, n)) * sensors.q_noise
        dq_noise = self.rng.normal(0.0, 1.0, (count, n)) * sensors.dq_noise
        q_true, dq_true = np.empty((count, n)), np.empty((count, n))
        q_read, cmd, tau = np.empty((count, n)), np.empty((count, n)), np.empty((count, n))
        qpos = np.empty((count, model.nq))
        kp, kd, step_of = control.kp, control.kd, sensors.q_step
        believed = world.believed if control.gravity_compensation else None
        plain = world.direct
        applied, now_q, now_v = self.applied, self.qpos, self.qvel
        rint, mj_step = np.rint, mujoco.mj_step
        share = 1.0 / substeps
        for k in range(count):
            if plain:
                q_true[k], dq_true[k] = now_q, now_v
            else:
                q_true[k], dq_true[k] = world.motors_of_joints(now_q, now_v)
            qpos[k] = now_q
            reading = rint((q_true[k] + q_noise[k]) / step_of) * step_of
            q_read[k] = reading
            speed = dq_true[k] + dq_noise[k]
            dq_noise[k] = speed
            torque = kp * (q_in[k] - reading) + kd * (dq_in[k] - speed)
            if believed is not None:
                torque += believed.gravity(reading)
            cmd[k] = torque
            if not laws and not drives:
                world.apply(applied, torque)
                mj_step(model, data, substeps)
                tau[k] = torque
                continue
            mean = 0.0
            for _ in range(substeps):
                exerted = torque
                for drive in drives:
                    exerted = drive(exerted)
                self.exerted = exerted
                world.apply(applied, exerted)
                for law in laws:
                    law()
                mj_step(model, data)
                mean = mean + exerted
            tau[k] = mean * share
        if not np.all(np.isfinite(qpos)) or np.max(np.abs(q_true - q_des)) > 1.5:
            raise RuntimeError("the simulated arm left its path")
        return Truth(
            time=time,
            q=q_true,
            dq=dq_true,
            tau=tau,
            tau_cmd=cmd,
            q_read=q_read,
            dq_read=dq_noise,
            q_des=q_des,
            dq_des=dq_des,
            qpos=qpos,
        )


class World:
    """The true machine under its controller."""

    def __init__(
        self,
        arm: Arm,
        armature: Array,
        control: Controller,
        sensors: Sensors,
        effects: tuple[Effect, ...],
        believed_arm: Arm | None = None,
    ) -> None:
        """`arm` and `armature` are what would be true without the effects."""
        self.effects, self.control, self.sensors = effects, control, sensors
        self.believed = Dynamics(believed_arm or arm, armature)
        self.machine = Machine.of(armature)
        self.offset = np.zeros(arm.n)  # joint = motor + offset
        self.coupling: tuple[int, int, float] | None = None  # joint k = motor k + ratio motor j
        for effect in effects:
            arm = effect.change_arm(arm)
        self.arm = arm
        for effect in effects:
            effect.change_machine(self.machine, arm)
            self._geometry(effect)
        xml = mjcf(arm, self.machine, TIMESTEP)
        self.model: Any = mujoco.MjModel.from_xml_string(xml)
        ids = [self.model.joint(f"m{k}").qposadr[0] for k in range(arm.n)]
        self.motor: Any = np.array(ids) if self.model.nq > arm.n else slice(None)
        self.direct = self.model.nq == arm.n and self.coupling is None and not self.offset.any()

    def _geometry(self, effect: Effect) -> None:
        offset = getattr(effect, "encoder_offset", None)
        if offset is not None:
            self.offset[effect.joint] += offset
        ratio = getattr(effect, "motor_ratio", None)
        if ratio is not None:
            self.coupling = (*effect.joints(None), ratio)

    def dof(self, joint: int) -> int:
        """MuJoCo's index of a joint's motor side hinge."""
        return int(np.arange(self.model.nv)[self.motor][joint])

    def joints_of_motors(self, q: Array) -> Array:
        """Joint positions (n,) at the encoders' positions."""
        result = q + self.offset
        if self.coupling is not None:
            k, j, ratio = self.coupling
            result[k] += ratio * q[j]
        return result

    def motors_of_joints(self, qpos: Array, qvel: Array) -> tuple[Array, Array]:
        """What the encoders see of MuJoCo's state."""
        q, v = qpos[self.motor] - self.offset, qvel[self.motor].copy()
        if self.coupling is not None:
            k, j, ratio = self.coupling
            q[k] -= ratio * q[j]
            v[k] -= ratio * v[j]
        return q, v

    def apply(self, applied: Array, torque: Array) -> None:
        """The motors' torques as forces on MuJoCo's hinges; what was applied before is gone."""
        if self.coupling is not None:
            k, j, ratio = self.coupling
            torque = torque.copy()
            torque[j] -= ratio * torque[k]
        applied[self.motor] = torque
