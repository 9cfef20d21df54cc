"""The H1 in MuJoCo: the tree of h1.urdf, collision shapes, motors, and how its feet are held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from pdoik.h1.objects import FlyingObject, add_object
from pdoik.h1.robot import FEET, JOINT_NAMES, ROOT_LINK, FloatArray, Joint, Link, figures
from pdoik.h1.scenery import add_looks, add_scenery, color_of
from pdoik.h1.shapes import SHAPES, SOLE_HEIGHT, SOLE_RADIUS, Shape, sole_centers

IntArray = npt.NDArray[np.int64]

TIMESTEP = 0.001  # [s]
ARMATURE = 0.1  # [kg m^2]
DAMPING = 1.0  # [N m s/rad]
HIP_HALF_SPAN = 0.0875 + 0.11536  # from the URDF: half the ankles' distance at q = 0, [m]

# Kinds of geometry that may touch: two do if one's contype meets the other's conaffinity.
FLOOR_BIT, OBJECT_BIT = 1, 2

# MuJoCo's refsafe raises a solref below two time steps: 0.002 s is the stiffest that stays.
WELD_SOLREF = (2 * TIMESTEP, 1.0)
WELD_SOLIMP = (0.99, 0.999, 0.001, 0.5, 2.0)
FLOOR_SOLREF = (0.005, 1.0)
FLOOR_FRICTION = (1.0, 0.005, 0.0001)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Where the ankles are and what holds the feet."""

    name: str
    ankle_x: float  # the left one's; the right one's is its negative, [m]
    feet: Literal["weld and ball", "welds", "floor"]
    com_feedback: bool = False  # whether the controller pulls the CoM to where the posture has it

    @property
    def T_world_base(self) -> FloatArray:
        """Pose of the left ankle link, the solver's base: it faces -y. (4, 4) [m]."""
        return self._ankle(self.ankle_x)

    @property
    def T_world_tip(self) -> FloatArray:
        """Goal of the right ankle link; for `paper` its position only. (4, 4) [m]."""
        return self._ankle(-self.ankle_x)

    @property
    def T_base_tip(self) -> FloatArray:
        """The same goal as the solver wants it, (4, 4) [m]."""
        return np.asarray(np.linalg.inv(self.T_world_base) @ self.T_world_tip)

    @property
    def floor_z(self) -> float:
        """Height of the floor, [m]; z is 0 at the ankles."""
        return -SOLE_HEIGHT

    @staticmethod
    def _ankle(x: float) -> FloatArray:
        T = np.eye(4)
        T[:3, :3] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]  # ahead is -y, left is +x
        T[0, 3] = x
        return T


PAPER = Setup(name="paper", ankle_x=0.2, feet="weld and ball")
WELDED = Setup(name="welded", ankle_x=HIP_HALF_SPAN, feet="welds")
FREE = Setup(name="free", ankle_x=HIP_HALF_SPAN, feet="floor")
BALANCED = Setup(name="balanced", ankle_x=HIP_HALF_SPAN, feet="floor", com_feedback=True)
SETUPS = {setup.name: setup for setup in (PAPER, WELDED, FREE, BALANCED)}


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

    def standing_data(self, q: FloatArray) -> mujoco.MjData:
        """At rest in posture q (19,), the left ankle where the set-up has it, no object near."""
        data = mujoco.MjData(self.model)
        data.qpos[self.qpos_index] = q
        mujoco.mj_kinematics(self.model, data)  # the pelvis at the origin
        T_pelvis_ankle = body_pose(data, self.feet[0])
        T_pelvis_ankle = np.linalg.inv(body_pose(data, self.root)) @ T_pelvis_ankle
        T_world_pelvis = self.setup.T_world_base @ np.linalg.inv(T_pelvis_ankle)
        data.qpos[:3] = T_world_pelvis[:3, 3]
        data.qpos[3:7] = Rotation.from_matrix(T_world_pelvis[:3, :3]).as_quat(scalar_first=True)
        if self.thing is not None:
            data.mocap_pos[0] = (0.0, 0.0, 100.0)
        mujoco.mj_forward(self.model, data)
        return data


def body_pose(data: mujoco.MjData, body: int) -> FloatArray:
    """T_world_body, (4, 4) [m]."""
    T = np.eye(4)
    T[:3, :3] = data.xmat[body].reshape(3, 3)
    T[:3, 3] = data.xpos[body]
    return T


def build_world(setup: Setup, thing: FlyingObject | None = None) -> World:
    """The model for a set-up, with the object as a body that is moved along (mocap)."""
    spec = mujoco.MjSpec()
    spec.modelname = "h1"
    spec.compiler.degree = False
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10
    _add_robot(spec)
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


def _add_robot(spec: mujoco.MjSpec) -> None:
    robot = figures()
    bodies = {ROOT_LINK: _add_link(spec.worldbody, robot.links[ROOT_LINK], None)}
    bodies[ROOT_LINK].add_freejoint(name="floating_base")
    for joint in robot.joints.values():  # parents come first
        bodies[joint.child] = _add_link(bodies[joint.parent], robot.links[joint.child], joint)
    for k, shape in enumerate(SHAPES):
        _add_shape(bodies[shape.link], shape, f"{shape.link}_{k}")
    for foot in FEET:
        bodies[foot].add_site(name=f"{foot}_site", group=4)
        for k, center in enumerate(sole_centers()):
            bodies[foot].add_geom(
                name=f"{foot}_sole_{k}",
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                pos=center,
                size=[SOLE_RADIUS, 0, 0],
                contype=FLOOR_BIT,
                conaffinity=0,
                group=3,
            )
    for name in JOINT_NAMES:
        effort = robot.joints[name].effort
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.ctrllimited = True
        motor.ctrlrange = [-effort, effort]


def _add_link(parent: mujoco.MjsBody, link: Link, joint: Joint | None) -> mujoco.MjsBody:
    xyz, rpy = (joint.xyz, joint.rpy) if joint else ((0, 0, 0), (0, 0, 0))
    wxyz = Rotation.from_euler("xyz", rpy).as_quat(scalar_first=True)
    body = parent.add_body(name=link.name, pos=xyz, quat=wxyz)
    body.explicitinertial = True
    body.mass, body.ipos, body.fullinertia = link.mass, link.center, link.inertia
    if joint:
        hinge = body.add_joint(name=joint.name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=joint.axis)
        hinge.limited = True
        hinge.range = [joint.lower, joint.upper]
        hinge.armature = ARMATURE
    return body


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
