"""The H1 in MuJoCo: h1.urdf with collision shapes, motors, and how its feet are held."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.humanoid.world.objects import FlyingObject, add_object
from bench.humanoid.world.robot import URDF, Setup
from bench.humanoid.world.scenery import add_looks, add_scenery, color_of
from pdoik.view.h1_shapes import (
    FEET,
    JOINT_NAMES,
    ROOT_LINK,
    SHAPES,
    SOLE_HALF_WIDTH,
    SOLE_HEEL,
    SOLE_HEIGHT,
    SOLE_TOE,
    Shape,
)

IntArray = npt.NDArray[np.int64]

TIMESTEP = 0.001  # [s]
ARMATURE = 0.1  # [kg m^2]
DAMPING = 1.0  # [N m s/rad]
SOLE_RADIUS = 0.005  # of the six balls that a foot stands on, [m]

# Kinds of geometry that may touch: two do if one's contype meets the other's conaffinity.
FLOOR_BIT, OBJECT_BIT = 1, 2

# MuJoCo's refsafe raises a solref below two time steps: 0.002 s is the stiffest that stays.
WELD_SOLREF = (2 * TIMESTEP, 1.0)
WELD_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)
FLOOR_SOLREF = (0.005, 1.0)
FLOOR_FRICTION = (1.0, 0.005, 0.0001)


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A compiled model and where its parts are. Index arrays follow JOINT_NAMES."""

    setup: Setup
    model: mujoco.MjModel
    qpos_index: IntArray  # (19,) into qpos
    dof_index: IntArray  # (19,) into qvel
    root: int  # the pelvis' body
    feet: tuple[int, int]  # bodies, left and right
    robot_geoms: tuple[int, ...]  # what the object may touch
    object_geoms: tuple[int, ...]  # none without an object
    thing: FlyingObject | None

    @property
    def object_pairs(self) -> IntArray:
        """Each piece of the object with each shape of the robot, (N, 2) geoms."""
        robot, pieces = np.meshgrid(self.robot_geoms, self.object_geoms)
        return np.column_stack([robot.ravel(), pieces.ravel()]).astype(np.int64)

    @property
    def effort(self) -> FloatArray:
        """The motors' largest torques, (19,) [N m]."""
        return np.asarray(self.model.actuator_ctrlrange[:, 1])

    def standing_data(self, q: FloatArray) -> mujoco.MjData:
        """State at rest in posture q (19,), the left ankle at its set-up, no object near."""
        data = mujoco.MjData(self.model)
        self.place(data, q)
        if self.thing is not None:
            data.mocap_pos[0] = (0.0, 0.0, 100.0)
        mujoco.mj_forward(self.model, data)
        return data

    def place(
        self, data: mujoco.MjData, q: FloatArray, T_world_object: FloatArray | None = None
    ) -> None:
        """Put the robot in posture q (19,) with its left foot in place, and the object (4, 4)."""
        data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]
        data.qpos[self.qpos_index] = q
        mujoco.mj_kinematics(self.model, data)
        T_world_pelvis = self.setup.T_world_base @ np.linalg.inv(body_pose(data, self.feet[0]))
        put(T_world_pelvis, data.qpos[:3], data.qpos[3:7])
        if T_world_object is not None:
            put(T_world_object, data.mocap_pos[0], data.mocap_quat[0])
        mujoco.mj_kinematics(self.model, data)


def body_pose(data: mujoco.MjData, body: int) -> FloatArray:
    """T_world_body, (4, 4) [m]."""
    T = np.eye(4)
    T[:3, :3] = data.xmat[body].reshape(3, 3)
    T[:3, 3] = data.xpos[body]
    return T


def put(T: FloatArray, position: FloatArray, wxyz: FloatArray) -> None:
    """Write a pose (4, 4) into MuJoCo's position (3,) and quaternion (4,)."""
    position[:] = T[:3, 3]
    mujoco.mju_mat2Quat(wxyz, T[:3, :3].ravel())


def least_distance(
    model: mujoco.MjModel, data: mujoco.MjData, pairs: IntArray, cutoff: float
) -> float:
    """Least distance of pairs of geoms (N, 2), negative where two overlap; at most `cutoff`, [m].

    Pairs whose bounding balls are farther apart than the nearest pair so far are passed over.
    """
    a, b = pairs.T
    gaps = np.linalg.norm(data.geom_xpos[a] - data.geom_xpos[b], axis=1)
    gaps -= model.geom_rbound[a] + model.geom_rbound[b]
    least = cutoff
    for k in np.argsort(gaps):
        if gaps[k] >= least:
            break
        found = mujoco.mj_geomDistance(model, data, int(a[k]), int(b[k]), least, None)
        least = min(least, float(found))
    return least


def build_world(setup: Setup, thing: FlyingObject | None = None) -> World:
    """The model for a set-up, with the object as a body that is moved along (mocap)."""
    spec = mujoco.MjSpec.from_file(str(URDF))
    spec.compiler.fusestatic = False  # the pelvis is a body of its own
    spec.compiler.discardvisual = False  # which descriptions are read with
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10
    _complete_robot(spec)
    _add_floor(spec, setup)
    _hold_feet(spec, setup)
    if thing is not None:
        add_object(spec, thing, OBJECT_BIT)
    add_looks(spec)
    add_scenery(spec)
    return _index(spec.compile(), setup, thing)


def _index(model: mujoco.MjModel, setup: Setup, thing: FlyingObject | None) -> World:
    joints = [model.joint(name).id for name in JOINT_NAMES]
    geoms = range(model.ngeom)
    model.dof_damping[model.jnt_dofadr[joints]] = DAMPING  # here: the spec's field changes shape
    return World(
        setup=setup,
        model=model,
        qpos_index=model.jnt_qposadr[joints].astype(np.int64),
        dof_index=model.jnt_dofadr[joints].astype(np.int64),
        root=model.body(ROOT_LINK).id,
        feet=(model.body(FEET[0]).id, model.body(FEET[1]).id),
        robot_geoms=tuple(i for i in geoms if model.geom_conaffinity[i] & OBJECT_BIT),
        object_geoms=tuple(i for i in geoms if model.geom_contype[i] & OBJECT_BIT),
        thing=thing,
    )


def _complete_robot(spec: mujoco.MjSpec) -> None:
    """What the description has not: a base that floats, rotors, shapes, soles, motors."""
    spec.body(ROOT_LINK).add_freejoint(name="floating_base")
    for k, shape in enumerate(SHAPES):
        _add_shape(spec.body(shape.link), shape, f"{shape.link}_{k}")
    for foot in FEET:
        spec.body(foot).add_site(name=f"{foot}_site", group=4)
        for k, center in enumerate(sole_centers()):
            spec.body(foot).add_geom(
                name=f"{foot}_sole_{k}",
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                pos=center,
                size=[SOLE_RADIUS, 0, 0],
                contype=FLOOR_BIT,
                conaffinity=0,
                group=3,
            )
    for name in JOINT_NAMES:
        joint = spec.joint(name)
        joint.armature = ARMATURE
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.ctrllimited = True
        motor.ctrlrange = joint.actfrcrange  # the description's effort


def sole_centers() -> FloatArray:
    """Centres of the six balls under a foot, (6, 3) in the ankle link's frame [m]."""
    heel, toe = SOLE_HEEL + SOLE_RADIUS, SOLE_TOE - SOLE_RADIUS
    width = SOLE_HALF_WIDTH - SOLE_RADIUS
    return np.array(
        [
            (x, y, SOLE_RADIUS - SOLE_HEIGHT)
            for x in (heel, (heel + toe) / 2, toe)
            for y in (-width, width)
        ]
    )


def _add_shape(body: mujoco.MjsBody, shape: Shape, name: str) -> None:
    geom = body.add_geom(
        name=name, contype=0, conaffinity=OBJECT_BIT, rgba=color_of(shape), group=1
    )
    if shape.kind == "sphere":
        geom.type, geom.pos = mujoco.mjtGeom.mjGEOM_SPHERE, shape.a
        geom.size = [shape.radius, 0, 0]
    else:
        is_capsule = shape.kind == "capsule"
        geom.type = mujoco.mjtGeom.mjGEOM_CAPSULE if is_capsule else mujoco.mjtGeom.mjGEOM_CYLINDER
        geom.fromto = [*shape.a, *shape.b]
        geom.size = [shape.radius, 0, 0]


def _add_floor(spec: mujoco.MjSpec, setup: Setup) -> None:
    floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE)
    floor.pos, floor.size = [0, 0, setup.floor_z], [6, 6, 0.05]
    floor.contype, floor.conaffinity = 0, FLOOR_BIT if setup.feet == "floor" else 0
    floor.solref[:], floor.friction = FLOOR_SOLREF, FLOOR_FRICTION
    floor.priority = 1  # its figures hold for the contact, not a mean with the sole's


def _hold_feet(spec: mujoco.MjSpec, setup: Setup) -> None:
    if setup.feet == "floor":
        return
    weld, ball = mujoco.mjtEq.mjEQ_WELD, mujoco.mjtEq.mjEQ_CONNECT
    targets = (setup.T_world_base, setup.T_world_tip)
    kinds = (weld, weld if setup.feet == "welds" else ball)
    for foot, T, kind in zip(FEET, targets, kinds, strict=True):
        wxyz = Rotation.from_matrix(T[:3, :3]).as_quat(scalar_first=True)
        spec.worldbody.add_site(name=f"{foot}_goal", pos=T[:3, 3], quat=wxyz, group=4)
        hold = spec.add_equality(
            name=f"{foot}_hold",
            type=kind,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=f"{foot}_site",
            name2=f"{foot}_goal",
            solref=WELD_SOLREF,
            solimp=WELD_SOLIMP,
        )
        hold.data[:] = 0
        hold.data[10] = 1  # [m]: what a weld multiplies its rotation's error by
