"""The user's simulator as it is: MuJoCo's model of a file, and which control moves which joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..simulation import build_plant, mjcf_text, movable_joints, read_description
from ..study import Controller, Study

HINGE, SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_NO_BIAS = int(mujoco.mjtBias.mjBIAS_NONE)
_SENSOR = "pdoik.torque."
_OF_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UserModel:
    """A compiled model with its joints' places. Arrays are in the order of the study's joints.

    Equalities, tendons, contacts, limits, integrator and step are those of the file; sensors of
    the joints' actuator torques are appended, which changes no motion.
    """

    name: str
    source: Path | str  # the MJCF's file, or the text that was made of a URDF
    model: Any  # mujoco.MjModel
    joints: tuple[str, ...]
    joint_ids: tuple[int, ...]
    qpos: tuple[int, ...]
    dof: tuple[int, ...]
    actuators: tuple[int, ...]
    controls: tuple[int, ...]  # places in `ctrl`
    torque_sensors: tuple[int, ...]  # places in `sensordata`
    degrees: bool  # whether angles in its source are in degrees
    law_outside: bool  # whether gains are the study's controller's, not the file's
    law: Controller | None = None  # whose desired speeds and gravity are fed forward, too
    notes: tuple[str, ...] = ()

    @property
    def timestep(self) -> float:
        """[s]."""
        return float(self.model.opt.timestep)

    def body_of(self, k: int) -> int:
        """The body that the k-th joint moves."""
        return int(self.model.jnt_bodyid[self.joint_ids[k]])

    def trees(self) -> tuple[int, ...]:
        """The part of the machine, by joint, that moves without the others' help.

        Joints of one kinematic tree belong together; equalities, tendons and contacts may couple
        trees, so with any of these all joints are one part.
        """
        model = self.model
        coupled = bool(model.neq or model.ntendon or _collides(model))
        return tuple(0 if coupled else int(model.dof_treeid[dof]) for dof in self.dof)


def simulator_of(study: Study) -> UserModel | None:
    """The model that the study's `simulator` names; None without one.

    Raises:
        LoadError: it cannot be read, floats, or lacks a joint or its actuator.
    """
    file = study.simulator
    if file is None:
        return None
    if file.format == "urdf":
        return _of_urdf(file.path, study)
    return user_model(
        file.path,
        study.joints,
        controller=study.controller,
        actuators=file.actuators,
    )


def description_of(study: Study) -> UserModel | None:
    """The study's `robot` under its `controller`, as a simulator; None without a robot."""
    if study.robot is None:
        return None
    if read_description(study.robot).format == "mjcf":
        return user_model(study.robot, study.joints, controller=study.controller)
    return _of_urdf(study.robot, study)


def user_model(
    source: Path | str,
    joints: Sequence[str],
    *,
    name: str | None = None,
    controller: Controller | None = None,
    actuators: Mapping[str, str] | None = None,
) -> UserModel:
    """The model of an MJCF.

    Args:
        source: its file, or its text.
        joints: of the study, each driven by a position command.
        name: of the file, for messages.
        controller: law of joints whose actuators are motors, or that have none.
        actuators: name by joint, where a joint has several.

    Raises:
        LoadError: MuJoCo cannot read it, it floats, a joint or its actuator is missing.
    """
    name = name or (source.name if isinstance(source, Path) else "the MJCF")
    joints, named = tuple(joints), dict(actuators or {})
    spec = _spec(source, name)
    _check_joints(spec, joints, name)
    outside = add_law(spec, joints, controller, named) if controller is not None else False
    for joint in joints:
        spec.add_sensor(
            name=f"{_SENSOR}{joint}",
            type=mujoco.mjtSensor.mjSENS_JOINTACTFRC,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=joint,
        )
    try:
        model = spec.compile()
    except ValueError as error:
        raise LoadError(f"{name}: MuJoCo cannot compile it: {_words(error)}") from error
    ids = tuple(int(model.joint(joint).id) for joint in joints)
    driven = tuple(
        _actuator_of(model, k, named.get(joint), joint, name)
        for k, joint in zip(ids, joints, strict=True)
    )
    addresses = getattr(model, "actuator_ctrladr", np.arange(model.nu))
    return UserModel(
        name=name,
        source=source,
        model=model,
        joints=joints,
        joint_ids=ids,
        qpos=tuple(int(model.jnt_qposadr[k]) for k in ids),
        dof=tuple(int(model.jnt_dofadr[k]) for k in ids),
        actuators=driven,
        controls=tuple(int(addresses[k]) for k in driven),
        torque_sensors=tuple(
            int(model.sensor_adr[model.sensor(f"{_SENSOR}{joint}").id]) for joint in joints
        ),
        degrees=bool(spec.compiler.degree),
        law_outside=outside,
        law=controller if outside else None,
    )


def _of_urdf(path: Path, study: Study) -> UserModel:
    """A URDF's links and joints with the study's gains as position actuators."""
    controller = study.controller
    if controller is None:
        raise LoadError(
            f"{path.name}: a URDF has no gains: expected 'controller: {{kp: ..., kd: ...}}' in the"
            " study, or an MJCF with position actuators"
        )
    described = read_description(path)
    others = tuple(j for j in movable_joints(described) if j not in study.joints)
    rotors = study.rotor_inertia
    if rotors is not None:
        rotors = np.concatenate([rotors, np.zeros(len(others))])
    plant = build_plant(path, (*study.joints, *others), rotor_inertia=rotors)
    position = []
    for k, joint in enumerate(study.joints):
        kp, kd = float(controller.kp[k]), float(controller.kd[k])
        position.append(
            {
                "name": joint,
                "joint": joint,
                "gainprm": f"{kp:.17g}",
                "biastype": "affine",
                "biasprm": f"0 {-kp:.17g} {-kd:.17g}",
            }
        )
        if controller.torque_limit is not None:
            limit = float(controller.torque_limit[k])
            position[-1]["forcerange"] = f"{-limit:.17g} {limit:.17g}"
    text = mjcf_text(plant.model, comment=[f"made of {path.name}"], actuators=position)
    return replace(user_model(text, study.joints, name=path.name), law=controller)


def _spec(source: Path | str, name: str) -> Any:
    try:
        if isinstance(source, Path):
            return mujoco.MjSpec.from_file(str(source))
        return mujoco.MjSpec.from_string(source)
    except ValueError as error:
        raise LoadError(f"{name}: MuJoCo cannot read it: {_words(error)}") from error


def _check_joints(spec: Any, joints: Sequence[str], name: str) -> None:
    kinds = {joint.name: int(joint.type) for joint in spec.joints}
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    for joint in spec.joints:
        if int(joint.type) == free:
            raise LoadError(
                f"{name}: joint {joint.name!r} lets body {joint.parent.name!r} float, and"
                " recordings have no pose of a base; expected the base fixed as it was when it was"
                " recorded: hang or bolt the machine up, and leave the <freejoint> out of the model"
            )
    for joint in joints:
        if joint not in kinds:
            raise LoadError(f"{name}: no joint {joint!r}{nearest(joint, kinds)}")
        if kinds[joint] not in (HINGE, SLIDE):
            raise LoadError(f"{name}: joint {joint!r} is a ball, expected a hinge or a slide")


def _actuator_of(model: Any, joint_id: int, named: str | None, joint: str, name: str) -> int:
    """The position actuator of a joint."""
    names = [model.actuator(k).name or f"actuator {k}" for k in range(model.nu)]
    moves = [
        k
        for k in range(model.nu)
        if int(model.actuator_trntype[k]) in _OF_JOINT
        and int(model.actuator_trnid[k, 0]) == joint_id
    ]
    if named is not None:
        if named not in names:
            raise LoadError(f"simulator: actuators: {name} has no {named!r}{nearest(named, names)}")
        if names.index(named) not in moves:
            raise LoadError(f"simulator: actuators: {named!r} of {name} does not move {joint!r}")
        return names.index(named)
    servos = [k for k in moves if model.actuator_biasprm[k, 1] != 0.0]
    if len(servos) == 1:
        return servos[0]
    if servos:
        shown = ", ".join(names[k] for k in servos)
        raise LoadError(
            f"{name}: joint {joint!r} has several position actuators ({shown}); say in the study"
            f" which one takes q_des: 'simulator: {{actuators: {{{joint}: {names[servos[0]]}}}}}'"
        )
    what = f"only {', '.join(names[k] for k in moves)}" if moves else "none"
    raise LoadError(
        f"{name}: joint {joint!r} needs a position actuator for q_des, and has {what}"
        f"{nearest(joint, names) if not moves else ''}; expected one in the MJCF, or gains in the"
        " study: 'controller: {kp: ..., kd: ...}'"
    )


def add_law(
    spec: Any, joints: Sequence[str], controller: Controller, named: Mapping[str, str]
) -> bool:
    """Let motors of the study's joints follow its controller's law; True where some do.

    A motor with gain G and gear g gives g G ctrl. As a position actuator it gives
    kp (q_des - q) - kd dq, at most what its control range allowed.
    """
    changed = False
    for k, joint in enumerate(joints):
        mine = [a for a in spec.actuators if a.target == joint]
        if any(a.biasprm[1] != 0.0 for a in mine) or joint in named:
            continue
        kp, kd = float(controller.kp[k]), float(controller.kd[k])
        motors = [a for a in mine if int(a.biastype) == _NO_BIAS]
        if motors:
            motor, gear = motors[0], float(motors[0].gear[0])
            strength = float(motor.gainprm[0])
            low, high = (float(each) for each in motor.ctrlrange)
            if low < high:
                motor.forcerange = (strength * low, strength * high)
                motor.ctrlrange = (0.0, 0.0)
                motor.ctrllimited = int(mujoco.mjtLimited.mjLIMITED_FALSE)
        else:
            gear = 1.0
            motor = spec.add_actuator(
                name=f"pdoik.{joint}", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT
            )
            if controller.torque_limit is not None:
                limit = float(controller.torque_limit[k])
                motor.forcerange = (-limit, limit)
        motor.gaintype, motor.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        gain, bias = np.zeros(len(motor.gainprm)), np.zeros(len(motor.biasprm))
        gain[0] = kp / gear
        bias[1:3] = -kp / gear**2, -kd / gear**2
        motor.gainprm, motor.biasprm = gain, bias
        changed = True
    return changed


def _collides(model: Any) -> bool:
    """Whether any two of its geoms may touch."""
    if model.npair:
        return True
    if not model.ngeom:
        return False
    types, affinities = model.geom_contype, model.geom_conaffinity
    return bool(np.bitwise_or.reduce(types) & np.bitwise_or.reduce(affinities))


def _words(error: ValueError) -> str:
    """MuJoCo's own words, in one line."""
    return " ".join(str(error).split())
