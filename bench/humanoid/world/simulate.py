"""Run a throw in MuJoCo under a controller that is given where to go, and record everything."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.common.arrays import FloatArray
from bench.humanoid.world.controller import Controller
from bench.humanoid.world.model import World, least_distance, put
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER
from bench.humanoid.world.throws import Throw
from pdoik.view.h1_shapes import JOINT_NAMES

Desired = Callable[[float, FloatArray, FloatArray], FloatArray]
"""(t [s], q (19,) [rad], cloud of the object (K, 3) in the world [m]) -> q_des (19,) [rad]."""

DESIRED_PERIOD = 0.01  # [s]
DISTANCE_PERIOD = 0.002  # [s]
DISTANCE_CUTOFF = 0.5  # what is farther than this is recorded as this, [m]
FALLEN_PELVIS_HEIGHT = 0.5  # over the ankles, [m]
FALLEN_COM = 0.25  # of the CoM ahead of the ankles or behind them: nothing brings it back [m]
AT_THE_END = 0.1  # what of a run is its end [s]
STANDS = 0.03  # how far beyond the box of Eq. com the CoM may end: who falls goes farther [m]
FALLEN_FOOT_TILT = np.radians(15.0)  # of a foot on the floor, [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class Push:
    """A force on the torso's centre of mass."""

    force: tuple[float, float, float]  # world [N]
    begin: float  # [s]
    end: float  # [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """The first time the object touches the robot."""

    time: float  # [s]
    robot_geom: str
    link: str
    position: tuple[float, float, float]  # world [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What happened. T steps; joint columns follow JOINT_NAMES."""

    time: FloatArray  # (T,) [s]
    q_des: FloatArray  # (T, 19) [rad]
    q: FloatArray  # (T, 19) [rad]
    dq: FloatArray  # (T, 19) [rad/s]
    tau: FloatArray  # (T, 19) [N m]
    com: FloatArray  # (T, 3), world [m]
    feet: FloatArray  # (T, 2, 7): left and right ankle, position [m] and wxyz
    qpos: FloatArray  # (T, nq): MuJoCo's, to draw from
    object_pose: FloatArray  # (T, 7): position [m] and wxyz
    distance_time: FloatArray  # (D,) [s]
    distance: FloatArray  # (D,): object to robot, negative where they overlap [m]
    contact: Contact | None
    fallen: bool
    saturation: FloatArray  # (19,): share of steps at the torque limit

    @property
    def stands(self) -> bool:
        """Neither fallen nor about to: at the end the CoM is in its box (Eq. com)."""
        end = self.com[self.time >= self.time[-1] - AT_THE_END]
        inside = (end > COM_LOWER - STANDS) & (end < COM_UPPER + STANDS)
        return not self.fallen and bool(inside.all())

    @property
    def dodged(self) -> bool:
        """Untouched, and it stands."""
        return self.contact is None and self.stands

    @property
    def least_distance(self) -> float:
        """Over the whole run, [m]; at most DISTANCE_CUTOFF."""
        return float(self.distance.min()) if len(self.distance) else float("inf")

    @property
    def foot_drift(self) -> float:
        """The farthest that an ankle went from where it began, [m]."""
        return float(np.linalg.norm(self.feet[:, :, :3] - self.feet[0, :, :3], axis=2).max())


def hold(q: FloatArray) -> Desired:
    """Desire posture q (19,) whatever comes: the control run."""
    return lambda _t, _q, _cloud: q


def simulate(
    world: World,
    q0: FloatArray,
    desired: Desired,
    duration: float | None = None,
    *,
    throw: Throw | None = None,
    push: Push | None = None,
    desired_period: float = DESIRED_PERIOD,
    stop_at_contact: bool = False,
) -> Run:
    """Start at rest in q0 (19,) and ask `desired` for joint targets every desired_period.

    Args:
        world: Built with the throw's object, if there is a throw.
        q0: Where the robot starts, [rad].
        desired: Called at t = 0 first.
        duration: [s]; None takes the throw's.
        throw: What flies.
        push: What pushes.
        desired_period: Between two calls of `desired`, [s].
        stop_at_contact: End the run where the object first touches the robot. It is not stopped by
            what it meets and would push the robot along.
    """
    if duration is None:
        if throw is None:
            raise ValueError("duration is None, expected seconds when there is no throw")
        duration = throw.duration
    if (throw is None) != (world.thing is None):
        raise ValueError("expected a throw and a world with its object, or neither")
    model, dt = world.model, float(world.model.opt.timestep)
    n_steps = round(duration / dt)
    every, look_every = (max(1, round(p / dt)) for p in (desired_period, DISTANCE_PERIOD))
    data, controller = world.standing_data(q0), Controller(world)
    controller.reset(q0)
    torso = model.body("torso_link").id
    no_cloud, q_des = np.empty((0, 3)), np.array(q0, dtype=np.float64)
    record = _Record(world, n_steps)
    for k in range(n_steps):
        t = k * dt
        if throw is not None:
            put(throw.pose(t), data.mocap_pos[0], data.mocap_quat[0])
        mujoco.mj_step1(model, data)
        if k % every == 0:
            cloud = throw.cloud(world.thing, t) if throw and world.thing else no_cloud
            q_des = np.asarray(desired(t, data.qpos[world.qpos_index], cloud), dtype=np.float64)
        data.ctrl[:] = controller.torque(data, q_des)
        data.xfrc_applied[torso, :3] = push.force if push and push.begin <= t < push.end else 0
        record.step(data, t, q_des)
        if throw is not None and k % look_every == 0:
            record.look(data, t)
        if record.fallen or (stop_at_contact and record.contact):
            break
        mujoco.mj_step2(model, data)
    return record.run()


class _Record:
    """Arrays filled as the run goes."""

    def __init__(self, world: World, n_steps: int) -> None:
        self._world = world
        self._pairs = world.object_pairs
        self._n = 0
        n_joints = len(JOINT_NAMES)
        self._time = np.empty(n_steps)
        self._q_des, self._q, self._dq, self._tau = np.empty((4, n_steps, n_joints))
        self._com = np.empty((n_steps, 3))
        self._feet = np.empty((n_steps, 2, 7))
        self._qpos = np.empty((n_steps, world.model.nq))
        self._object = np.empty((n_steps, 7))
        self._distances: list[tuple[float, float]] = []
        self.contact: Contact | None = None
        self.fallen = False

    def step(self, data: mujoco.MjData, t: float, q_des: FloatArray) -> None:
        world, k = self._world, self._n
        self._time[k] = t
        self._q_des[k] = q_des
        self._q[k] = data.qpos[world.qpos_index]
        self._dq[k] = data.qvel[world.dof_index]
        self._tau[k] = data.ctrl
        self._com[k] = data.subtree_com[world.root]
        for side, foot in enumerate(world.feet):
            self._feet[k, side, :3], self._feet[k, side, 3:] = data.xpos[foot], data.xquat[foot]
        self._qpos[k] = data.qpos
        self._n += 1
        self.fallen = self._has_fallen(data)
        if world.thing is not None:
            self._object[k, :3], self._object[k, 3:] = data.mocap_pos[0], data.mocap_quat[0]
            if self.contact is None:
                self.contact = self._first_contact(data, t)

    def look(self, data: mujoco.MjData, t: float) -> None:
        """Measure the distance."""
        distance = least_distance(self._world.model, data, self._pairs, DISTANCE_CUTOFF)
        self._distances.append((t, distance))

    def _has_fallen(self, data: mujoco.MjData) -> bool:
        root = self._world.root
        if data.xpos[root, 2] < FALLEN_PELVIS_HEIGHT:
            return True
        if abs(data.subtree_com[root, 1]) > FALLEN_COM:
            return True
        on_floor = self._world.setup.feet == "floor"
        return on_floor and bool(
            min(data.xmat[foot, 8] for foot in self._world.feet) < np.cos(FALLEN_FOOT_TILT)
        )

    def _first_contact(self, data: mujoco.MjData, t: float) -> Contact | None:
        model, pieces = self._world.model, self._world.object_geoms
        for k in range(data.ncon):
            contact = data.contact[k]
            pair = (int(contact.geom1), int(contact.geom2))
            if contact.dist < 0 and (pair[0] in pieces or pair[1] in pieces):
                geom = model.geom(pair[1] if pair[0] in pieces else pair[0])
                x, y, z = map(float, contact.pos)
                link = model.body(geom.bodyid[0]).name
                return Contact(time=t, robot_geom=geom.name, link=link, position=(x, y, z))
        return None

    def run(self) -> Run:
        n, effort = self._n, self._world.effort
        distances = np.array(self._distances).reshape(-1, 2)
        return Run(
            time=self._time[:n],
            q_des=self._q_des[:n],
            q=self._q[:n],
            dq=self._dq[:n],
            tau=self._tau[:n],
            com=self._com[:n],
            feet=self._feet[:n],
            qpos=self._qpos[:n],
            object_pose=self._object[:n],
            distance_time=distances[:, 0],
            distance=distances[:, 1],
            contact=self.contact,
            fallen=self.fallen,
            saturation=np.asarray(np.mean(np.abs(self._tau[:n]) >= effort - 1e-9, axis=0)),
        )


def replay(world: World, run: Run, k: int) -> mujoco.MjData:
    """MuJoCo's data at step k of a run, for pictures."""
    data = mujoco.MjData(world.model)
    data.qpos[:] = run.qpos[k]
    if world.thing is not None:
        data.mocap_pos[0], data.mocap_quat[0] = run.object_pose[k, :3], run.object_pose[k, 3:]
    mujoco.mj_forward(world.model, data)
    return data
