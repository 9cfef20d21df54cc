"""The machine in MuJoCo: links of the URDF, drives, feet, ground and IMU as they truly are."""

from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from bench.sim2real.legged.machine import Machine
from bench.sim2real.legged.robots import Robot
from bench.sim2real.legged.spec import Array

TIMESTEP = 5e-4  # [s]
SOFT = 0.2  # impedance of contacts: low, so that they are springs and dampers [-]
DAMPING = 0.7  # ratio of a foot on the ground
GRAVITY = 9.81


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A compiled model and where its parts are, in the robot's order."""

    machine: Machine
    model: Any
    held: bool
    qpos: Any  # (n,) of the motors in qpos
    dof: Any  # (n,) of the motors in qvel
    base: int  # body
    feet: tuple[int, ...]  # bodies


def build(machine: Machine, hold: Array | None = None) -> World:
    """The model.

    Args:
        machine: as it truly is.
        hold: pose (7,) x y z qw qx qy qz at which the base is held; None: it floats.
    """
    robot = machine.robot
    spec = mujoco.MjSpec.from_string(urdf_text(robot))
    if hold is None:
        spec.body(robot.base).add_freejoint(name="floating_base")
    else:
        spec.body(robot.base).pos, spec.body(robot.base).quat = hold[:3], hold[3:]
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 100.0
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    _bodies(spec, machine)
    _joints(spec, machine)
    _feet(spec, machine)
    _imu(spec, machine)
    floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE)
    floor.size, floor.pos = [5.0, 5.0, 0.05], [0.0, 0.0, machine.ground]
    tilt = Rotation.from_rotvec([*machine.slope, 0.0])
    floor.quat = tilt.as_quat(scalar_first=True)
    floor.contype, floor.conaffinity = (0, 0) if hold is not None else (0, 1)
    model = spec.compile()
    _springs_of_feet(model, machine)
    joints = [model.joint(name).id for name in robot.joints]
    model.dof_damping[model.jnt_dofadr[joints]] = machine.viscous
    model.jnt_stiffness[joints] = np.reshape(machine.spring, model.jnt_stiffness[joints].shape)
    model.qpos_spring[model.jnt_qposadr[joints]] = machine.spring_rest
    return World(
        machine=machine,
        model=model,
        held=hold is not None,
        qpos=model.jnt_qposadr[joints],
        dof=model.jnt_dofadr[joints],
        base=model.body(robot.base).id,
        feet=tuple(model.body(foot).id for foot in robot.feet),
    )


def urdf_text(robot: Robot) -> str:
    root = ElementTree.parse(robot.urdf).getroot()
    for link in root.findall("link"):
        for looks in (*link.findall("visual"), *link.findall("collision")):
            link.remove(looks)
    for old in root.findall("mujoco"):
        root.remove(old)
    extension = ElementTree.SubElement(root, "mujoco")
    ElementTree.SubElement(extension, "compiler", fusestatic="false")
    return ElementTree.tostring(root, encoding="unicode")


def body_of(robot: Robot, link: str) -> tuple[float, Array]:
    """Mass [kg] and centre of mass (3,) [m] of a link as described."""
    body = mujoco.MjSpec.from_string(urdf_text(robot)).body(link)
    return float(np.ravel(body.mass)[0]), np.array(body.ipos)


def massive_links(robot: Robot) -> list[str]:
    bodies = mujoco.MjSpec.from_string(urdf_text(robot)).bodies
    return [body.name for body in bodies if float(np.ravel(body.mass)[0]) > 1e-6]


def _bodies(spec: Any, machine: Machine) -> None:
    for link, change in machine.bodies.items():
        body = spec.body(link)
        body.mass *= change.scale
        body.inertia = np.asarray(body.inertia) * change.scale
        body.fullinertia = np.asarray(body.fullinertia) * change.scale
        body.ipos = np.asarray(body.ipos) + change.shift
    for k, load in enumerate(machine.loads):
        box = spec.body(load.link).add_body(name=f"load{k}", pos=load.com)
        box.mass, box.explicitinertial = load.mass, True
        box.ipos = [0.0, 0.0, 0.0]  # else it is the body's own place once more
        box.inertia = [load.mass * load.size**2 / 6.0] * 3


def _joints(spec: Any, machine: Machine) -> None:
    robot = machine.robot
    for k, name in enumerate(robot.joints):
        joint = spec.joint(name)
        joint.limited = False  # commands keep away from them
        joint.armature = machine.rotor[k]
        joint.frictionloss = machine.coulomb[k]
        joint.solref_friction = [2.0 * TIMESTEP, 1.0]
        joint.actfrclimited = False
        share = machine.drive_gain[k]
        motor = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.gaintype, motor.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        motor.gainprm[0] = share * robot.kp[k]
        motor.biasprm[1:3] = [-share * robot.kp[k], -share * robot.kd[k]]
        motor.forcelimited, motor.ctrllimited = True, False
        motor.forcerange = [-share * machine.limit[k], share * machine.limit[k]]
        if machine.gap[k] > 0.0:
            _play(joint, float(machine.gap[k]))


def _play(motor: Any, gap: float) -> None:
    """A second hinge between the motor's and the link, free between two flanks."""
    play = motor.parent.add_joint(name=f"{motor.name}_play", type=mujoco.mjtJoint.mjJNT_HINGE)
    play.axis, play.pos = motor.axis, motor.pos
    play.limited, play.range = True, [-0.5 * gap, 0.5 * gap]
    play.solref_limit, play.solimp_limit = [0.004, 1.0], [0.9, 0.99, 1e-4, 0.5, 2.0]


def _feet(spec: Any, machine: Machine) -> None:
    for foot, friction in zip(machine.robot.feet, machine.friction, strict=True):
        body = spec.body(foot)
        for k, pad in enumerate(machine.robot.pads):
            geom = body.add_geom(name=f"{foot}_{k}", type=mujoco.mjtGeom.mjGEOM_SPHERE)
            geom.size, geom.pos = [pad.radius, 0.0, 0.0], pad.center
            geom.friction = [friction, 0.0, 0.0]
            geom.condim, geom.priority = 3, 1
            geom.contype, geom.conaffinity, geom.mass = 1, 0, 0.0
            name = f"touch_{foot}_{k}"
            body.add_site(name=name, pos=pad.center, size=[1.5 * pad.radius] * 3)
            spec.add_sensor(
                name=name,
                type=mujoco.mjtSensor.mjSENS_TOUCH,
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=name,
            )


def _imu(spec: Any, machine: Machine) -> None:
    robot = machine.robot
    turn = Rotation.from_euler("xyz", robot.imu_rpy) * Rotation.from_rotvec(machine.imu_tilt)
    wxyz = turn.as_quat(scalar_first=True)
    spec.body(robot.base).add_site(name="imu", pos=robot.imu_position, quat=wxyz)
    for name, kind in (
        ("gyro", mujoco.mjtSensor.mjSENS_GYRO),
        ("acc", mujoco.mjtSensor.mjSENS_ACCELEROMETER),
    ):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu")


def _springs_of_feet(model: Any, machine: Machine) -> None:
    """Contacts that are springs of the feet's stiffness: force = K depth + C speed.

    MuJoCo divides an acceleration k depth + b speed by its regularizer (1 - d) / d * A, where A is
    the foot's inverse mass as compiled.
    """
    pads = len(machine.robot.pads)
    for foot, stiffness in zip(machine.robot.feet, machine.stiffness, strict=True):
        inverse = float(model.body_invweight0[model.body(foot).id, 0])
        damping = 2.0 * DAMPING * np.sqrt(stiffness / inverse)
        for k in range(pads):
            geom = model.geom(f"{foot}_{k}").id
            scale = (1.0 - SOFT) * inverse / pads
            model.geom_solref[geom] = [-stiffness * scale, -damping * scale]
            model.geom_solimp[geom] = [SOFT, SOFT, 1e-3, 0.5, 2.0]
