"""Changes to a description's tree, before it is compiled."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from .description import nearest
from .parts import GearPlay, Part, Placement

SLIDE, HINGE = int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE)


def hold_others(spec: Any, joints: tuple[str, ...]) -> dict[str, Any]:
    """Bodies by the study's joints; the other joints are removed, which holds them."""
    names = [joint.name for joint in spec.joints]
    for name in joints:
        nearest(name, names, "joint")
    bodies = {}
    for joint in list(spec.joints):
        if joint.name not in joints:
            spec.delete(joint)
            continue
        if int(joint.type) not in (SLIDE, HINGE):
            raise ValueError(f"joint {joint.name} has not one degree of freedom")
        bodies[joint.name] = joint.parent
    return bodies


def move(body: Any, part: Placement) -> None:
    """T_parent_body times the placement."""
    moved, turned = np.empty(3), np.empty(4)
    mujoco.mju_rotVecQuat(moved, np.array(part.translation), body.quat)
    angle = float(np.linalg.norm(part.rotation))
    axis = np.array(part.rotation) / (angle or 1.0)
    delta = np.empty(4)
    mujoco.mju_axisAngle2Quat(delta, axis, angle)
    mujoco.mju_mulQuat(turned, body.quat, delta)
    body.pos, body.quat = body.pos + np.array(part.shift) + moved, turned


def gears_of(parts: tuple[Part, ...], joints: tuple[str, ...]) -> dict[int, GearPlay]:
    """One per joint: play and spring in series where a joint has both.

    Raises:
        ValueError: a stiffness is not positive.
    """
    gears: dict[int, GearPlay] = {}
    for part in parts:
        if not isinstance(part, GearPlay):
            continue
        if part.gap > 1e-9 or np.isfinite(part.stiffness) or part.waves:
            if not part.stiffness > 0.0:
                raise ValueError(f"stiffness of {part.joint} is {part.stiffness}, expected more")
            k = joints.index(nearest(part.joint, joints, "joint"))
            other = gears.get(k, GearPlay(joint=part.joint))
            compliance = 1.0 / part.stiffness + 1.0 / other.stiffness
            gears[k] = GearPlay(
                joint=part.joint,
                gap=part.gap + other.gap,
                stiffness=1.0 / compliance if compliance else float("inf"),
                damping=part.damping + other.damping,
                waves=part.waves + other.waves,
            )
    return gears


def play_name(joint: str) -> str:
    """Name of the joint between a joint's motor and link."""
    return f"{joint}.play"


def add_play(spec: Any, joint: Any, gear: GearPlay) -> None:
    """A second joint along the first in the same body: the link's place seen from the motor."""
    stop = np.isinf(gear.stiffness) and not gear.is_rigid
    if gear.is_rigid:
        tie = spec.add_equality(name=play_name(joint.name), type=mujoco.mjtEq.mjEQ_JOINT)
        tie.objtype = mujoco.mjtObj.mjOBJ_JOINT
        tie.name1, tie.name2 = play_name(joint.name), joint.name
    joint.parent.add_joint(
        name=play_name(joint.name),
        type=joint.type,
        pos=joint.pos,
        axis=joint.axis,
        limited=stop,
        range=(-gear.gap / 2, gear.gap / 2),
    )


def add_point(spec: Any, link: str) -> str:
    """A massless body at a link's origin: a force on it acts there."""
    link = nearest(link, [body.name for body in spec.bodies], "link")
    body = spec.body(link)
    name = f"{link}.pushed"
    if name not in [child.name for child in body.bodies]:
        body.add_body(name=name)
    return name
