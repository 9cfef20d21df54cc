"""A robot with its findings, a step at a time: also what MJCF and URDF cannot express."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.descriptions import quiet_mujoco
from pdoik.errors import PdoikError
from pdoik.recordings import FloatArray

from .drive import DelayLine, Drive, combine
from .joint_laws import JointLaws
from .parts import DriveChange, ExternalForce, Part, Vector
from .plant import STANDARD_GRAVITY, Plant, build_plant
from .sensors import Sensors

LONGEST_STEP = 0.1  # numerics: [s]
UNSTABLE = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)
RUNAWAY = 1e3  # numerics: no joint is that fast [rad/s]


class SimulationError(PdoikError):
    """A simulated robot left all bounds; the message says when and at which joint."""


class Stepper:
    """Steps MuJoCo's model of a robot together with the parts that MuJoCo has no words for.

    Torques are commands to the drives: they may be delayed, limited and lag before they act.
    `model` and `data` are MuJoCo's and may be read, and given other forces through `xfrc_applied`
    and `ctrl`, between steps; `qfrc_applied` is written by every step. MuJoCo moves positions by
    speeds of the step's end, so its `qpos` is kept half a step ahead of `qvel`, as leapfrog has
    it: that makes the motion exact to second order. `q` is where the joints are now::

        stepper = load_model("report/model.json").stepper()
        stepper.reset(q0)
        for _ in range(1000):
            stepper.step(kp * (q_des - stepper.q) - kd * stepper.dq)
    """

    def __init__(
        self,
        robot: str | Path,
        joints: Sequence[str],
        parts: Iterable[Part] = (),
        *,
        rotor_inertia: FloatArray | None = None,
        tip: str | None = None,
        gravity: Vector = STANDARD_GRAVITY,
        timestep: float = 1e-3,
    ) -> None:
        """Build the model.

        Args:
            robot: File of a URDF or MJCF, or the text of one.
            joints: Order of everything per joint; other joints of the robot are held at zero.
            parts: What is added to the description.
            rotor_inertia: (n,) at the joints [kg m^2]; None: the description's armatures.
            tip: Link whose pose is `tip_pose`; the last joint's otherwise.
            gravity: In the base frame [m/s^2].
            timestep: [s]; `laws.longest_step` says which stiff parts allow.

        Raises:
            ValueError: a joint or link is missing, or a figure is no robot's.
        """
        self.joints, self.parts = tuple(joints), tuple(parts)
        self.plant: Plant = build_plant(
            robot, self.joints, self.parts, rotor_inertia=rotor_inertia, gravity=gravity, tip=tip
        )
        self.sensors = Sensors(self.joints, self.parts)
        self.model: Any = self.plant.model  # mujoco.MjModel
        self.data: Any = mujoco.MjData(self.model)  # mujoco.MjData
        self._dof = self.plant.dof
        self._unstable = [self.data.warning[int(kind)] for kind in UNSTABLE]
        self._qpos, self._qvel = self.data.qpos, self.data.qvel
        self._qacc, self._constraint = self.data.qacc, self.data.qfrc_constraint
        self._applied = self.data.qfrc_applied
        self._nv = int(self.model.nv)
        self._identity = self._dof == tuple(range(self._nv))
        self.laws = JointLaws(self.plant, self.parts)
        self.recording: str | None = None  # forces of other recordings do not act; None: all act
        self._forces = list(
            zip(
                (part for part in self.parts if isinstance(part, ExternalForce)),
                self.plant.pushed,
                strict=True,
            )
        )
        self._drives_of = {
            k: combine((p for p in self.parts if isinstance(p, DriveChange)), joint)
            for k, joint in enumerate(self.joints)
        }
        self._set_timestep(timestep)
        self.reset()

    @property
    def timestep(self) -> float:
        """Length of a step [s]."""
        return float(self.model.opt.timestep)

    @timestep.setter
    def timestep(self, dt: float) -> None:
        self._set_timestep(dt)
        self._forget()

    def _set_timestep(self, dt: float) -> None:
        if not 0 < dt < LONGEST_STEP:
            raise ValueError(f"timestep must be between 0 and 0.1 s, got {dt}")
        self.plant.set_timestep(dt)
        self._dt = dt

    # State

    def reset(self, q: FloatArray | None = None, dq: FloatArray | None = None) -> None:
        """Time 0, measured positions q (n,) and speeds dq (n,), drives and friction settled."""
        mujoco.mj_resetData(self.model, self.data)
        n = len(self.joints)
        self._forget()
        self.place(np.zeros(n) if q is None else q, np.zeros(n) if dq is None else dq)
        mujoco.mj_forward(self.model, self.data)
        data, bias = self.data, self.data.qfrc_bias
        for k, gear in self.plant.gears.items():
            play = self.plant.play[k]
            if np.isfinite(gear.stiffness):
                data.qpos[play] = -bias[play] / gear.stiffness
            data.qpos[play] -= np.sign(bias[play]) * gear.gap / 2
            if not gear.is_rigid:
                data.qpos[play] += gear.error(float(data.qpos[self._dof[k]]))[0]
        mujoco.mj_forward(self.model, data)

    def place(self, q: FloatArray, dq: FloatArray, only: Sequence[int] | None = None) -> None:
        """Put the motors at measured q with dq; links keep their place in the play.

        Args:
            q: (n,) [rad] or [m].
            dq: (n,).
            only: Places of the joints that are put there, others go on; None: all.
        """
        chosen = list(range(len(self._dof)) if only is None else only)
        dof = [self._dof[k] for k in chosen]
        if only is None:
            self.data.qvel[:] = 0.0
        self.data.qpos[dof] = self.sensors.true("q", np.asarray(q, dtype=float))[chosen]
        self.data.qvel[dof] = self.sensors.true("dq", np.asarray(dq, dtype=float))[chosen]
        self.data.qpos[dof] += 0.5 * self._dt * self.data.qvel[dof]
        for k, gear in self.plant.gears.items():
            if gear.is_rigid and k in chosen:
                value, slope, _ = gear.error(float(self.data.qpos[self._dof[k]]))
                self.data.qpos[self.plant.play[k]] = value
                self.data.qvel[self.plant.play[k]] = slope * self.data.qvel[self._dof[k]]

    @property
    def q(self) -> FloatArray:
        """Measured positions, (n,)."""
        now = self._qpos - 0.5 * self._dt * self._qvel
        return self.sensors.measured("q", now[list(self._dof)])

    @property
    def dq(self) -> FloatArray:
        """Measured speeds, (n,)."""
        return self.sensors.measured("dq", self.data.qvel[list(self._dof)])

    @property
    def tau(self) -> FloatArray:
        """Torques of the last step as the drives report them, (n,)."""
        return self.sensors.measured("tau", np.array(self._reported))

    @property
    def tip_pose(self) -> FloatArray:
        """T_base_tip, (4, 4): where the tip truly is."""
        pose = self.tip_poses((self._qpos - 0.5 * self._dt * self._qvel)[None])[0]
        T, R = np.eye(4), np.empty(9)
        mujoco.mju_quat2Mat(R, pose[3:])
        T[:3, :3], T[:3, 3] = R.reshape(3, 3), pose[:3]
        return T

    def tip_poses(self, positions: FloatArray) -> FloatArray:
        """Where the tip is for values (T, nq) of qpos: x y z qw qx qy qz, (T, 7)."""
        data: Any = mujoco.MjData(self.model)
        poses = np.empty((len(positions), 7))
        for pose, row in zip(poses, positions, strict=True):
            data.qpos[:] = row
            mujoco.mj_kinematics(self.model, data)
            pose[:3], pose[3:] = data.xpos[self.plant.tip], data.xquat[self.plant.tip]
        return poses

    def _forget(self) -> None:
        """Reset drives, delays and friction to before the first command."""
        dt, n = self._dt, len(self.joints)
        changes = self._drives_of
        self._drives = [
            (k, Drive(change, dt))
            for k, change in changes.items()
            if replace(change, delay=0.0, command_lag=0.0, torque_delay=0.0)
            != DriveChange(joint=change.joint)
        ]
        self._delays = [(k, DelayLine(c.delay, dt)) for k, c in changes.items() if c.delay > 0]
        self._torque_delays = [
            (k, DelayLine(c.torque_delay, dt)) for k, c in changes.items() if c.torque_delay > 0
        ]
        self._reported = [0.0] * n
        self.laws.forget()

    # Steps

    def step(self, torque: Sequence[float] | FloatArray) -> None:
        """One step with commanded torques (n,) [N m].

        Raises:
            SimulationError: the robot ran away.
        """
        command = [float(each) for each in torque]
        if len(command) != len(self.joints):
            raise ValueError(
                f"torque has {len(command)} entries, the robot has {len(self.joints)} joints"
            )
        for k, line in self._delays:
            command[k] = line(command[k])
        data = self.data
        with quiet_mujoco():
            self.advance(command, data.qpos.tolist(), data.qvel.tolist())
        self.check(data.qvel.tolist())

    def drive_of(self, k: int) -> DriveChange:
        """What the k-th joint's drive makes of commands."""
        return self._drives_of[k]

    def check(self, velocity: list[float]) -> None:
        """Raises SimulationError where a speed is no robot's."""
        if max(velocity) < RUNAWAY and min(velocity) > -RUNAWAY:
            if any(each.number for each in self._unstable):
                raise SimulationError("MuJoCo found the simulation unstable and started it anew")
            return
        fast = int(np.argmax(np.abs(np.nan_to_num([velocity[k] for k in self._dof], nan=np.inf))))
        inertia = 1.0 / self.plant.inverse_inertia(np.zeros(len(self.joints)))[fast, fast]
        raise SimulationError(
            f"the simulation ran away at {self.data.time:.3f} s, joint {self.joints[fast]} first: "
            f"its inertia in the model is {inertia:.3g} kg m^2, rotor included"
        )

    def advance(self, command: list[float], q: list[float], v: list[float]) -> list[float]:
        """One step from qpos q and qvel v, for commands that `delay` was applied to already.

        Returns:
            Torques as the drives report them, before their sensors' gain and skew, (n,).
        """
        if self._torque_delays:
            command = command[:]
            for k, line in self._torque_delays:
                command[k] = line(command[k])
        reported, exerted = command, command
        if self._drives:
            reported, exerted = command[:], command[:]
            for k, drive in self._drives:
                reported[k], exerted[k] = drive(command[k], v[self._dof[k]])
        return self._finish(reported, exerted, q, v)

    def advance_exerted(self, reported: list[float], q: list[float], v: list[float]) -> list[float]:
        """One step with what the drives reported, which no drive delays or limits again."""
        changes = self._drives_of
        exerted = [(u - changes[k].offset) / changes[k].gain for k, u in enumerate(reported)]
        return self._finish(reported, exerted, q, v)

    def _finish(
        self, reported: list[float], exerted: list[float], q: list[float], v: list[float]
    ) -> list[float]:
        data, laws = self.data, self.laws
        self._reported = reported
        if self._identity:
            applied = exerted[:]
        else:
            applied = [0.0] * self._nv
            for dof, torque in zip(self._dof, exerted, strict=True):
                applied[dof] = torque
        if not laws.none:
            laws.apply(data.time, q, v, applied)
        for k, j, ratio in self.sensors.couplings:
            applied[self._dof[j]] -= ratio * exerted[k]
        if self._forces:
            self._push(data.time)
        self._applied[:] = applied
        mujoco.mj_step(self.model, data)
        if laws.loaded:
            laws.feel_load(applied, v, self._constraint.tolist(), self._qacc.tolist())
        if laws.memories:
            laws.remember(self._qpos.tolist(), self._qvel.tolist(), self._dt)
        return reported

    def _push(self, t: float) -> None:
        force = self.data.xfrc_applied
        for _, body in self._forces:
            force[body, :3] = 0.0
        for part, body in self._forces:
            begin, end = part.window or (0.0, np.inf)
            here = not part.recordings or self.recording in (None, *part.recordings)
            if here and begin <= t <= end:
                force[body, :3] += part.force
