"""The solver's answers judged by others: Pinocchio's kinematics on the URDF, MuJoCo's distances."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pinocchio

from bench.common.arrays import FloatArray
from bench.humanoid.trials.measures import beyond_box
from bench.humanoid.trials.store import Record
from bench.humanoid.world.model import IntArray, World, least_distance
from bench.humanoid.world.robot import BASE_LINK, TIP_LINK, URDF, robot_in_world
from bench.humanoid.world.simulate import DISTANCE_CUTOFF
from bench.humanoid.world.throws import Throw
from pdoik.view.h1_shapes import JOINT_NAMES

SELF_EVERY = 20  # answers between two whose own limbs are compared
SELF_CUTOFF = 0.1  # what is farther than this counts as this [m]


def check_answers(world: World, throw: Throw | None, time: FloatArray, q: FloatArray) -> Record:
    """Judge joint targets q (T, 19) at times (T,), left foot in place: nothing moves here.

    Distances are of the object where it is at that time, from MuJoCo's shapes; the right foot and
    the centre of mass are Pinocchio's.
    """
    setup, data = world.setup, world.standing_data(q[0])
    kinematics = PinocchioKinematics()
    pairs = self_pairs(world)
    position, rotation, least, least_self = 0.0, 0.0, DISTANCE_CUTOFF, SELF_CUTOFF
    com = np.empty((len(q), 3))
    for k, (t, posture) in enumerate(zip(time, q, strict=True)):
        T_base_tip, com_base = kinematics(posture)
        T = setup.T_world_base @ T_base_tip
        com[k] = setup.T_world_base[:3, :3] @ com_base + setup.T_world_base[:3, 3]
        position = max(position, float(np.linalg.norm((T - setup.T_world_tip)[:3, 3])))
        rotation = max(rotation, _angle(setup.T_world_tip[:3, :3].T @ T[:3, :3]))
        world.place(data, posture, None if throw is None else throw.pose(t))
        if throw is not None:
            least = least_distance(world.model, data, world.object_pairs, least)
        if k % SELF_EVERY == 0:
            least_self = least_distance(world.model, data, pairs, least_self)
    return {
        "position_error": position,
        "rotation_error": None if setup.feet == "weld and ball" else rotation,
        "com_beyond_box": beyond_box(com).max(axis=0),
        "least_distance": least if throw is not None else None,
        "self_distance": least_self,
    }


def self_pairs(world: World) -> IntArray:
    """Shapes of links that are neither one, adjacent, nor always near one another, (N, 2)."""
    model = world.model
    ignored = {frozenset(pair) for pair in robot_in_world(world.setup).ignored_pairs}
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
    return np.array(pairs)


def _angle(R: FloatArray) -> float:
    s = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(s, np.trace(R) - 1))


class PinocchioKinematics:
    """T_base_tip and the centre of mass in the base frame, from the URDF alone."""

    def __init__(self) -> None:
        # A floating root: a fixed one's mass would be left out.
        self._model = pinocchio.buildModelFromUrdf(str(URDF), pinocchio.JointModelFreeFlyer())
        self._data = self._model.createData()
        self._q = pinocchio.neutral(self._model)
        joints = [self._model.getJointId(name) for name in JOINT_NAMES]
        self._index = np.array([self._model.joints[joint].idx_q for joint in joints])
        self._feet = [self._model.getFrameId(link) for link in (BASE_LINK, TIP_LINK)]

    def __call__(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        self._q[self._index] = q
        pinocchio.framesForwardKinematics(self._model, self._data, self._q)
        left, right = (self._data.oMf[foot].homogeneous for foot in self._feet)
        com = pinocchio.centerOfMass(self._model, self._data, self._q)
        return np.linalg.inv(left) @ right, left[:3, :3].T @ (com - left[:3, 3])
