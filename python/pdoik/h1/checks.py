"""The solver's answers judged by others: Pinocchio's kinematics on the URDF, MuJoCo's distances."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import Any

import mujoco
import numpy as np

from pdoik.h1 import problem
from pdoik.h1.measures import beyond_box
from pdoik.h1.model import World, body_pose
from pdoik.h1.robot import BASE_LINK, JOINT_NAMES, TIP_LINK, URDF, FloatArray
from pdoik.h1.simulate import DISTANCE_CUTOFF, object_distance
from pdoik.h1.store import Record
from pdoik.h1.throws import Throw

SELF_EVERY = 20  # answers between two whose own limbs are compared
SELF_CUTOFF = 0.1  # what is farther than this counts as this [m]


def check_answers(world: World, throw: Throw | None, time: FloatArray, q: FloatArray) -> Record:
    """Judge joint targets q (T, 19) at times (T,), left foot in place: nothing moves here.

    Distances are of the object where it is at that time, from MuJoCo's shapes; the right foot and
    the centre of mass are Pinocchio's, MuJoCo's where that is missing.
    """
    setup, data = world.setup, world.standing_data(q[0])
    kinematics = _pinocchio() or _MujocoKinematics(world)
    pairs = self_pairs(world)
    position, rotation, least, least_self = 0.0, 0.0, DISTANCE_CUTOFF, SELF_CUTOFF
    com = np.empty((len(q), 3))
    for k, (t, posture) in enumerate(zip(time, q, strict=True)):
        T_base_tip, com_base = kinematics(posture)
        T = setup.T_world_base @ T_base_tip
        com[k] = setup.T_world_base[:3, :3] @ com_base + setup.T_world_base[:3, 3]
        position = max(position, float(np.linalg.norm((T - setup.T_world_tip)[:3, 3])))
        rotation = max(rotation, _angle(setup.T_world_tip[:3, :3].T @ T[:3, :3]))
        place(world, data, posture, throw, t)
        if throw is not None:
            least = min(least, object_distance(world, data))
        if k % SELF_EVERY == 0:
            least_self = _self_distance(world, data, pairs, least_self)
    return {
        "by": type(kinematics).__name__.strip("_").removesuffix("Kinematics").lower(),
        "position_error": position,
        "rotation_error": None if setup.feet == "weld and ball" else rotation,
        "com_beyond_box": beyond_box(com).max(axis=0),
        "least_distance": least if throw is not None else None,
        "self_distance": least_self,
    }


def place(
    world: World, data: mujoco.MjData, q: FloatArray, throw: Throw | None = None, t: float = 0.0
) -> None:
    """Put the robot in posture q (19,) with its left foot in place, and the object where it is."""
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]
    data.qpos[world.qpos_index] = q
    mujoco.mj_kinematics(world.model, data)
    T = world.setup.T_world_base @ np.linalg.inv(body_pose(data, world.feet[0]))
    data.qpos[:3] = T[:3, 3]
    mujoco.mju_mat2Quat(data.qpos[3:7], T[:3, :3].ravel())
    if throw is not None:
        T_object = throw.pose(t)
        data.mocap_pos[0] = T_object[:3, 3]
        mujoco.mju_mat2Quat(data.mocap_quat[0], T_object[:3, :3].ravel())
    mujoco.mj_kinematics(world.model, data)


def self_pairs(world: World) -> list[tuple[int, int]]:
    """Shapes of links that are neither one, adjacent, nor always near one another."""
    model = world.model
    ignored = {frozenset(pair) for pair in problem.robot_in_world(world.setup).ignored_pairs}
    pairs = []
    for a, b in combinations(world.robot_geoms, 2):
        bodies = [int(model.geom_bodyid[geom]) for geom in (a, b)]
        adjacent = (
            bodies[0] == bodies[1]
            or model.body_parentid[bodies[0]] == bodies[1]
            or model.body_parentid[bodies[1]] == bodies[0]
        )
        names = frozenset(model.body(body).name for body in bodies)
        if not adjacent and names not in ignored:
            pairs.append((a, b))
    return pairs


def _self_distance(
    world: World, data: mujoco.MjData, pairs: list[tuple[int, int]], least: float
) -> float:
    model = world.model
    a, b = np.array(pairs).T
    gaps = np.linalg.norm(data.geom_xpos[a] - data.geom_xpos[b], axis=1)
    gaps -= model.geom_rbound[a] + model.geom_rbound[b]
    for k in np.argsort(gaps):
        if gaps[k] >= least:
            break
        found = mujoco.mj_geomDistance(model, data, int(a[k]), int(b[k]), least, None)
        least = min(least, float(found))
    return least


def _angle(R: FloatArray) -> float:
    s = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(s, np.trace(R) - 1))


class _PinocchioKinematics:
    """T_base_tip and the centre of mass in the base frame, from the URDF alone."""

    def __init__(self, pinocchio: Any) -> None:
        self._pinocchio = pinocchio
        # A floating root: a fixed one's mass would be left out.
        self._model = pinocchio.buildModelFromUrdf(str(URDF), pinocchio.JointModelFreeFlyer())
        self._data = self._model.createData()
        self._q = pinocchio.neutral(self._model)
        joints = [self._model.getJointId(name) for name in JOINT_NAMES]
        self._index = np.array([self._model.joints[joint].idx_q for joint in joints])
        self._feet = [self._model.getFrameId(link) for link in (BASE_LINK, TIP_LINK)]

    def __call__(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        self._q[self._index] = q
        self._pinocchio.framesForwardKinematics(self._model, self._data, self._q)
        left, right = (self._data.oMf[foot].homogeneous for foot in self._feet)
        com = self._pinocchio.centerOfMass(self._model, self._data, self._q)
        return np.linalg.inv(left) @ right, left[:3, :3].T @ (com - left[:3, 3])


class _MujocoKinematics:
    """The same from MuJoCo's model."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._data = mujoco.MjData(world.model)

    def __call__(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        world, data = self._world, self._data
        place(world, data, q)
        mujoco.mj_comPos(world.model, data)
        left, right = (body_pose(data, foot) for foot in world.feet)
        com = data.subtree_com[world.root]
        return np.linalg.inv(left) @ right, left[:3, :3].T @ (com - left[:3, 3])


@cache
def _pinocchio() -> _PinocchioKinematics | None:
    try:
        import pinocchio  # type: ignore[import-untyped, unused-ignore]
    except ModuleNotFoundError:
        return None
    return _PinocchioKinematics(pinocchio)
