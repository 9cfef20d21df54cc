"""One recording's simulation: commands, physics, and what is true at each row."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import mujoco
import numpy as np

from bench.sim2real.legged.postures import State
from bench.sim2real.legged.spec import Array
from bench.sim2real.legged.world import TIMESTEP, World

SETTLE = 1.0  # before the log begins [s]
TICKS = {200: (5, 2), 500: (4, 1)}  # rate of the log [Hz]: steps of a tick, ticks of a row
EACH = 2  # ticks of a command
LEAST_HEIGHT, MOST_TILT = 0.6, np.radians(40.0)  # of the standing height; what is worse has fallen


class FallenError(RuntimeError):
    """The robot lost its balance."""


class Policy(Protocol):
    """Whoever commands the robot."""

    def command(self, t: float, state: State) -> Array:
        """Position (n,) that is sent at a time [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rows:
    """What is true at each row, (T, ...); nothing is noisy yet."""

    time: Array
    q: Array  # true joint positions [rad]
    dq: Array  # that forces go by: MuJoCo's are half a step old
    speed: Array  # at the row
    ddq: Array
    read: Array  # the encoders' [rad]
    tau: Array  # delivered [N m]
    said: Array  # by the drives of what they deliver [N m]
    tau_cmd: Array  # that the drives asked of themselves [N m]
    q_des: Array
    base: Array  # (T, 7)
    twist: Array  # (T, 6) of the base: velocity in the world, turning in its own frame
    acceleration: Array  # (T, 6) the same's derivative
    gyro: Array  # (T, 3) of the IMU's true frame
    acc: Array  # (T, 3)
    contact: Array  # (T, feet) normal force [N]
    force: Array  # (T, feet, 3) of the ground on each foot, world [N]
    moment: Array  # (T, feet, 3) the same's moment about the foot's origin [N m]

    def averaged(self, names: tuple[str, ...], every: int) -> dict[str, Array]:
        """Channels as means about each row, before it is one row in so many."""
        result = {}
        for name in names:
            values = getattr(self, name)
            if every > 1:
                edge = np.concatenate([values[:1], values, values[-1:]])
                values = 0.25 * edge[:-2] + 0.5 * edge[1:-1] + 0.25 * edge[2:]
            result[name] = values[::every]
        return result


def simulate(
    world: World, policy: Policy, seconds: float, rate: int, start: tuple[Array, Array]
) -> Rows:
    """Moves the machine for a while after it has settled.

    Args:
        world: the machine.
        policy: who commands.
        seconds: of the log; commands begin with it, and hold their first before.
        rate: of the log, 200 or 500 [Hz].
        start: base pose (7,) and joints (n,) to begin at.
    """
    model, data, robot = world.model, mujoco.MjData(world.model), world.machine.robot
    steps, _ = TICKS[rate]
    tick = steps * TIMESTEP
    _set(world, data, start)
    settle, count = EACH * round(SETTLE / tick / EACH), round(seconds / tick)
    late = [max(1, 1 + round(d / tick)) for d in world.machine.delay]
    sent: deque[Array] = deque(maxlen=max(late))
    record = _Record(world, data, count)
    q_des = start[1]
    for k in range(-settle, count):
        state = _state(world, data)
        if k % 50 == 0:
            _check(world, state, robot.height)
        if k % EACH == 0:
            q_des = policy.command(max(0.0, k * tick), state)
        sent.append(q_des)
        acted = q_des
        if len(sent[0]) and max(late) > 1:
            acted = np.array([sent[-min(n, len(sent))][j] for j, n in enumerate(late)])
        data.ctrl[:] = acted + world.machine.joint_offset
        if k < 0:
            mujoco.mj_step(model, data, steps)
            continue
        record.before(k, state, q_des)
        for step in range(steps):
            record.step(k, acted, lambda: mujoco.mj_step(model, data), steps)
            if step == 0:
                record.after(k)
    return record.rows(tick)


def _set(world: World, data: Any, start: tuple[Array, Array]) -> None:
    base, q = start
    if not world.held:
        data.qpos[:7] = base
    data.qpos[world.qpos] = q + world.machine.joint_offset
    mujoco.mj_forward(world.model, data)


def _state(world: World, data: Any) -> State:
    read = data.qpos[world.qpos] - world.machine.joint_offset
    if world.held:
        base = np.concatenate([data.xpos[world.base], data.xquat[world.base]])
        return State(base=base, velocity=np.zeros(3), omega=np.zeros(3), q=read)
    return State(
        base=data.qpos[:7].copy(),
        velocity=data.qvel[:3].copy(),
        omega=data.qvel[3:6].copy(),
        q=read,
    )


def _check(world: World, state: State, height: float) -> None:
    if not np.isfinite(state.q).all():
        raise FallenError("the simulation diverged")
    if world.held:
        return
    up = 1.0 - 2.0 * (state.base[4] ** 2 + state.base[5] ** 2)  # of the trunk's z axis
    if state.base[2] < LEAST_HEIGHT * height or up < np.cos(MOST_TILT):
        raise FallenError(f"it fell: the base is at {state.base[2]:.2f} m")


def _centred(means: Array, steps: int) -> Array:
    """Means over ticks as means about rows: what jumps at rows is else seen at its youngest.

    A tick's steps begin with its row, so that their middle is half a step before the tick's.
    """
    late = 0.5 + 0.5 / steps
    return np.asarray(late * means + (1.0 - late) * np.concatenate([means[:1], means[:-1]]))


class _Sensors:
    """Where in MuJoCo's arrays the sensors are."""

    def __init__(self, world: World) -> None:
        model, robot = world.model, world.machine.robot
        self.gyro = int(model.sensor("gyro").adr[0])
        self.acc = int(model.sensor("acc").adr[0])
        pads = range(len(robot.pads))
        self.touch = np.array(
            [[model.sensor(f"touch_{foot}_{k}").adr[0] for k in pads] for foot in robot.feet]
        )


class _Record:
    """Arrays that fill up; MuJoCo's are looked at once, for they stay where they are."""

    def __init__(self, world: World, data: Any, count: int) -> None:
        self.world = world
        n, feet = world.machine.robot.n, len(world.feet)
        widths = {"q": n, "dq": n, "ddq": n, "read": n, "q_des": n, "drive": n, "ordered": n}
        widths |= {"tau": n, "speed": n}
        widths |= {"base": 7, "twist": 6, "acceleration": 6, "gyro": 3, "acc": 3, "contact": feet}
        self.table = {name: np.zeros((count, width)) for name, width in widths.items()}
        self.wrench, self.arm = np.zeros((count, feet, 6)), np.zeros((count, feet, 3))
        self._sensors, self._feet = _Sensors(world), np.array(world.feet)
        self._qvel, self._qacc, self._force = data.qvel, data.qacc, data.actuator_force
        self._qpos = data.qpos
        self._sensed, self._external = data.sensordata, data.cfrc_ext
        self._com, self._place = data.subtree_com[world.base], data.xpos

    def before(self, k: int, state: State, q_des: Array) -> None:
        """The state that the step begins with."""
        table, world = self.table, self.world
        table["q"][k] = state.q + world.machine.joint_offset
        table["dq"][k] = self._qvel[world.dof]
        table["read"][k], table["q_des"][k], table["base"][k] = state.q, q_des, state.base
        if not world.held:
            table["twist"][k] = self._qvel[:6]

    def step(self, k: int, acted: Array, step: Callable[[], None], steps: int) -> None:
        """One of a tick's steps: what the drives ask of themselves and give, as means over it."""
        robot, world = self.world.machine.robot, self.world
        read = self._qpos[world.qpos] - world.machine.joint_offset
        speed = self._qvel[world.dof].copy()
        step()
        speed = 0.5 * (speed + self._qvel[world.dof])  # when the position was read
        self.table["ordered"][k] += (robot.kp * (acted - read) - robot.kd * speed) / steps
        self.table["drive"][k] += self._force / steps

    def after(self, k: int) -> None:
        table, world, sensors, sensed = self.table, self.world, self._sensors, self._sensed
        table["ddq"][k] = self._qacc[world.dof]
        table["speed"][k] = 0.5 * (table["dq"][k] + self._qvel[world.dof])
        table["tau"][k] = self._force
        table["gyro"][k] = sensed[sensors.gyro : sensors.gyro + 3]
        table["acc"][k] = sensed[sensors.acc : sensors.acc + 3]
        if world.held:
            return
        table["acceleration"][k] = self._qacc[:6]
        table["contact"][k] = sensed[sensors.touch].sum(axis=1)
        self.wrench[k] = self._external[self._feet]  # moment about the centre of mass, force
        self.arm[k] = self._com - self._place[self._feet]

    def rows(self, tick: float) -> Rows:
        table, machine = self.table, self.world.machine
        steps = round(tick / TIMESTEP)
        table["q_des"] = _centred(table["q_des"], steps)
        ordered, given = (_centred(table.pop(name), steps) for name in ("ordered", "drive"))
        said = given / machine.drive_gain * machine.sensor_gain + machine.sensor_offset
        return Rows(
            time=tick * np.arange(len(said), dtype=np.float64),
            said=said,
            tau_cmd=ordered,
            force=self.wrench[:, :, 3:],
            moment=self.wrench[:, :, :3] + np.cross(self.arm, self.wrench[:, :, 3:]),
            **table,
        )
