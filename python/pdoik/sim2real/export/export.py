"""The improved model as URDF and MJCF, as far as these have words for what was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeGuard

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik._files import write_whole
from pdoik.recordings import FloatArray

from ..effects import parts_of_finding
from ..findings import Finding
from ..model import Model
from ..simulation import (
    HINGE,
    Dahl,
    Description,
    DofChange,
    DriveChange,
    GearPlay,
    GravityTilt,
    HardFriction,
    Inertial,
    JointTorque,
    LinkChange,
    Part,
    Placement,
    SensorChange,
    Vector,
    build_plant,
    combine,
    mjcf_text,
    movable_joints,
    nearest,
    odd_inertias,
    read_description,
    unphysical,
)
from .urdf import improve_urdf

_WIDTH_OF_REST = 0.05  # [rad/s] over which friction changes its sign, that is worth a word


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """A description and what it leaves out."""

    text: str
    left_out: tuple[str, ...]  # in words, of findings or of what the description had before


def write_exports(model: Model, folder: str | Path) -> tuple[Path, ...]:
    """Write improved.xml, and improved.urdf if the robot came as one; gives their paths."""
    folder = Path(folder)
    exports = {"improved.xml": export_mjcf(model)}
    if model.robot is not None and read_description(model.robot).format == "urdf":
        exports["improved.urdf"] = export_urdf(model)
    for name, export in exports.items():
        write_whole(folder / name, export.text)
    return tuple(folder / name for name in exports)


def export_mjcf(model: Model) -> Export:
    """MJCF with links, joints, torque actuators and gravity; shapes and scenes are not in it.

    Damping, frictionloss, armature, masses, springs, gravity, play and elasticity (as a second
    joint, `<joint>.play`), limits and lag of drives are expressed.

    Raises:
        ValueError: the study had no robot.
    """
    robot = _robot(model)
    described = read_description(robot)
    kept, left_out = _parted(model, _mjcf_has_words)
    parts = _placed(kept, robot)
    corrected = _corrected(model)
    others = tuple(j for j in movable_joints(described) if j not in model.joints)
    joints = model.joints + others
    armature = np.array([described.spec.joint(joint).armature for joint in joints])
    if model.rotor_inertia is not None:
        armature[: len(model.joints)] = model.rotor_inertia
    plant = build_plant(
        robot,
        joints,
        [*corrected, *parts],
        rotor_inertia=armature,
        gravity=model.gravity,
        tip=model.tip or described.links_of(model.joints)[-1],
    )
    left_out += _smooth_friction(model)
    left_out += _evened_out(described, model, [*corrected, *parts])
    left_out += tuple(
        f"link {link}: its moments of inertia break A + B >= C; MuJoCo evens them out on loading"
        for link in odd_inertias(plant.model)
    )
    changes = [part for part in parts if isinstance(part, DriveChange)]
    actuators = [_actuator(combine(changes, joint)) for joint in model.joints]
    comment = _comment("MJCF", left_out)
    return Export(
        text=mjcf_text(plant.model, comment=comment, actuators=actuators), left_out=left_out
    )


def export_urdf(model: Model) -> Export:
    """The user's URDF with damping, friction, inertials and joint frames as found.

    Raises:
        ValueError: the study had no robot, or it was no URDF.
    """
    robot = _robot(model)
    if read_description(robot).format != "urdf":
        raise ValueError("robot: it is an MJCF, expected a URDF to improve")
    kept, left_out = _parted(model, _urdf_has_words)
    if model.rotor_inertia is not None and np.any(model.rotor_inertia):
        left_out += ("rotor inertias known before the diagnosis",)
    left_out += _smooth_friction(model)
    parts = _placed(kept, robot)
    changes = [*_corrected(model), *parts]
    left_out += _evened_out(read_description(robot), model, changes)
    text = improve_urdf(robot, model.joints, changes, _comment("URDF", left_out))
    return Export(text=text, left_out=left_out)


def _evened_out(described: Description, model: Model, parts: list[Part]) -> tuple[str, ...]:
    links = unphysical(described, described.links_of(model.joints), parts)
    return tuple(
        f"link {link}: the inertia that was found is no body's; that of the nearest body is in here"
        for link in links
    )


def _smooth_friction(model: Model) -> tuple[str, ...]:
    """Dry friction that changes its sign over some width; URDF and MJCF know a step only."""
    widths = {
        "coulomb_friction": ("rad/s of rest", _WIDTH_OF_REST),
        "presliding_hysteresis": ("rad after a reversal", 0.0),
    }
    return tuple(
        f"the width of {f.joints[0]}'s dry friction: it changes its sign within"
        f" {f.shape[0]:.2g} {widths[f.effect][0]}, here at once"
        for f in model.findings
        if f.effect in widths and f.shape and f.shape[0] > widths[f.effect][1]
    )


def _robot(model: Model) -> str:
    if model.robot is None:
        raise ValueError("the study had no robot description, so there is none to improve")
    return model.robot


def _mjcf_has_words(part: Part) -> bool:
    if isinstance(part, HardFriction):
        return not callable(part.level)
    if isinstance(part, DriveChange):
        late = part.delay or part.command_lag or part.torque_delay
        falls = np.isfinite(part.no_load_speed)
        return not (late or falls or part.command_offset) and part.command_gain == 1.0
    if isinstance(part, SensorChange):
        return _is_zero_of_encoder(part)
    if isinstance(part, GearPlay):
        return not part.waves and (part.gap == 0.0 or np.isinf(part.stiffness))
    return isinstance(part, DofChange | GravityTilt | Placement) or _is_of_robot(part)


def _urdf_has_words(part: Part) -> bool:
    if isinstance(part, HardFriction):
        return not callable(part.level)
    if isinstance(part, DofChange):
        return part.armature == 0.0 and part.stiffness == 0.0
    if isinstance(part, SensorChange):
        return _is_zero_of_encoder(part)
    return isinstance(part, Placement) or _is_of_robot(part)


def _is_of_robot(part: Part) -> bool:
    """Whether it changes a link, and not what a recording is known to hold."""
    return isinstance(part, LinkChange) and not part.held


def _is_zero_of_encoder(part: SensorChange) -> bool:
    return (part.channel, part.gain, part.skew) == ("q", 1.0, 0.0)


def _parted(model: Model, has_words: Callable[[Part], bool]) -> tuple[list[Part], tuple[str, ...]]:
    """Parts that a format expresses, and the findings that it does not, in words."""
    kept: list[Part] = []
    left_out: list[str] = []
    gears = [part for f in model.findings for part in parts_of_finding(f) if _is_gear(part)]
    sprung = {part.joint for part in gears if not part.gap and np.isfinite(part.stiffness)}
    for finding in model.findings:
        parts = [_without_memory(part) for part in parts_of_finding(finding)]
        # Play and a spring in series in one joint are a law that no format has.
        mixed = any(_is_gear(part) and part.gap and part.joint in sprung for part in parts)
        if parts and all(map(has_words, parts)) and not mixed:
            kept.extend(parts)
        else:
            left_out.append(_words(finding))
    return kept, tuple(left_out)


def _without_memory(part: Part) -> Part:
    """Friction that builds up over a displacement as its full level from the first on."""
    if isinstance(part, JointTorque) and isinstance(part.law, Dahl):
        return HardFriction(joint=part.joint, level=part.law.level)
    return part


def _is_gear(part: Part) -> TypeGuard[GearPlay]:
    return isinstance(part, GearPlay)


def _words(finding: Finding) -> str:
    where = ", ".join(finding.joints + finding.links)
    values = ", ".join(
        f"{name} {estimate.value:.4g} {estimate.unit}".rstrip()
        for name, estimate in finding.parameters.items()
    )
    return f"{finding.effect}{' of ' * bool(where)}{where}: {values}"


def _comment(form: str, left_out: tuple[str, ...]) -> tuple[str, ...]:
    made = "Made by pdoik diagnose."
    if not left_out:
        return (f"{made} Everything that was found is in here.",)
    return (f"{made} Not in here, since {form} cannot say it (model.json does):", *left_out)


def _corrected(model: Model) -> list[Part]:
    return [
        LinkChange(link=link, inertial=Inertial.from_ten(ten.tolist()), replace=True)
        for link, ten in model.rigid_body.items()
    ]


def _placed(parts: list[Part], robot: str) -> list[Part]:
    """The parts with turned frames instead of encoders' zeros, which come last."""
    parts = sorted(parts, key=lambda part: isinstance(part, SensorChange))
    return [_with_placement(part, robot) for part in parts]


def _with_placement(part: Part, robot: str) -> Part:
    """An encoder's zero as a turn of the joint's frame: then the description takes raw readings."""
    if not isinstance(part, SensorChange):
        return part
    spec = read_description(robot).spec
    joint = spec.joint(nearest(part.joint, [each.name for each in spec.joints], "joint"))
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    if int(joint.type) != HINGE:
        return Placement(joint=part.joint, translation=_vector(part.offset * axis))
    R = Rotation.from_rotvec(part.offset * axis).as_matrix()
    anchor = np.array(joint.pos)
    return Placement(
        joint=part.joint,
        translation=_vector(anchor - R @ anchor),
        rotation=_vector(part.offset * axis),
    )


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(each) for each in values)
    return x, y, z


def _actuator(drive: DriveChange) -> dict[str, str]:
    """A torque motor that does to commands what the drive does."""
    motor = {"name": drive.joint, "joint": drive.joint}
    motor["gainprm"] = repr(1.0 / drive.gain)
    if drive.offset:
        motor |= {"biastype": "affine", "biasprm": repr(-drive.offset / drive.gain)}
    if np.isfinite(drive.limit):
        motor["ctrlrange"] = f"{-drive.limit!r} {drive.limit!r}"
    if drive.time_constant:
        motor |= {"dyntype": "filterexact", "dynprm": repr(drive.time_constant)}
    return motor
