"""A robot with parts as a MuJoCo model: everything of it that MuJoCo expresses itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pdoik.descriptions import quiet_mujoco
from pdoik.recordings import FloatArray

from .assemble import add_play, add_point, gears_of, hold_others, move, play_name
from .description import Description, nearest, read_description
from .inertial import Inertial
from .parts import (
    DofChange,
    ExternalForce,
    GearPlay,
    GravityTilt,
    HardFriction,
    LinkChange,
    Part,
    Placement,
    Vector,
)

STANDARD_GRAVITY: Vector = (0.0, 0.0, -9.81)
HEAVY = 1e9  # [kg m^2]
NO_INERTIA = 1e-9  # a joint that moves less cannot be simulated [kg m^2]
LONELY_INERTIA = 1e-3  # of a joint that moves none where none moves any [kg m^2]
RIGID_ROTOR_SHARE = 0.01  # the same where the gear is rigid: it counts as the link's
ROTOR_SHARE = 0.1  # of a joint's inertia, for a motor behind play whose rotor nobody knows
FINEST_STEP = 1e-4  # [s]
DAMPING_OF_STIFFEST = 0.3  # of a spring too stiff for any step, as a share of critical
SOLVED_IN = 2.0  # steps, by which hard constraints are met
STEP_PER_PERIOD = 0.5  # numerics: the longest step times the fastest angular frequency


@dataclass(slots=True, kw_only=True, eq=False)
class Plant:
    """A compiled robot and where its joints are in MuJoCo's arrays."""

    model: Any  # mujoco.MjModel
    joints: tuple[str, ...]
    dof: tuple[int, ...]  # of the joints (at their motors), in qpos and qvel alike
    play: tuple[int | None, ...]  # of the play between motor and link, where there is one
    gears: dict[int, GearPlay]  # by place in `joints`
    links: tuple[str, ...]  # that each joint moves
    tip: int  # body
    pushed: tuple[int, ...]  # bodies at which the external forces act, in their order
    fastest: float = 0.0  # angular frequency of the stiffest spring between bodies [rad/s]
    notes: tuple[str, ...] = ()

    def longest_step(self, longest: float, frequency: float = 0.0) -> float:
        """The step [s]: up to `longest`, short for the stiffest spring, at least `FINEST_STEP`."""
        fastest = max(self.fastest, frequency)
        if fastest * longest <= STEP_PER_PERIOD:
            return longest
        return max(STEP_PER_PERIOD / fastest, min(FINEST_STEP, longest))

    def set_timestep(self, dt: float) -> None:
        """Step length [s]; hard friction and end stops are as stiff as it allows."""
        model = self.model
        model.opt.timestep = dt
        model.dof_solref[:] = model.jnt_solref[:] = (SOLVED_IN * dt, 1.0)
        model.eq_solref[:] = (SOLVED_IN * dt, 1.0)

    def inverse_inertia(self, q: FloatArray) -> FloatArray:
        """What torques accelerate the joints by with the links at q, (n, n) [1/(kg m^2)]."""
        data = mujoco.MjData(self.model)
        data.qpos[list(self.dof)] = q
        armature = self.model.dof_armature.copy()
        for k, gear in self.gears.items():
            if gear.is_rigid:  # so heavy against the motor that it stays where it is
                self.model.dof_armature[self.play[k]] = HEAVY
        with quiet_mujoco():
            mujoco.mj_forward(self.model, data)
        unit = np.eye(self.model.nv)
        result = np.empty_like(unit)
        mujoco.mj_solveM(self.model, data, result, unit)
        self.model.dof_armature[:] = armature
        return result[np.ix_(self.dof, self.dof)]

    @quiet_mujoco()
    def set_armature(self, armature: FloatArray) -> None:
        """Rotor inertias at the joints, (n,) [kg m^2]."""
        if not np.array_equal(self.model.dof_armature[list(self.dof)], armature):
            self.model.dof_armature[list(self.dof)] = armature
            mujoco.mj_setConst(self.model, mujoco.MjData(self.model))


@quiet_mujoco()
def build_plant(
    robot: str | Path,
    joints: tuple[str, ...],
    parts: Iterable[Part] = (),
    *,
    rotor_inertia: FloatArray | None = None,
    gravity: Vector = STANDARD_GRAVITY,
    tip: str | None = None,
) -> Plant:
    """Compile a robot whose other joints are held at zero.

    Damping and dry friction of the description stay, as in inverse dynamics; its springs are left
    out, as there; its armatures hold where `rotor_inertia` is None. There are no end stops and no
    contacts. A changed link whose figures are no body's gets those of the nearest body.

    Raises:
        ValueError: a joint or link is missing, or a link's inertial parameters are no body's.
    """
    described = read_description(robot)
    spec, parts = described.spec, tuple(parts)
    bodies = hold_others(spec, joints)
    links = tuple(bodies[joint].name for joint in joints)
    for part in parts:
        if isinstance(part, Placement):
            move(bodies[nearest(part.joint, joints, "joint")], part)
    gears = gears_of(parts, joints)
    for k, gear in gears.items():
        add_play(spec, spec.joint(joints[k]), gear)
    forces = [part for part in parts if isinstance(part, ExternalForce)]
    pushed = [add_point(spec, part.link or links[-1]) for part in forces]
    tip = nearest(tip or links[-1], described.links, "link")

    armature = {joint.name: joint.armature for joint in spec.joints}
    for joint in spec.joints:
        joint.armature = 1.0  # a motor and its link's play alone are singular
    model = spec.compile()
    notes = _set_inertials(model, described, links, parts)
    _set_options(model, gravity, parts)
    address = {model.joint(j).name: int(model.jnt_dofadr[j]) for j in range(model.njnt)}
    dof = tuple(address[joint] for joint in joints)
    plant = Plant(
        model=model,
        joints=joints,
        dof=dof,
        play=tuple(address.get(play_name(joint)) for joint in joints),
        gears=gears,
        links=links,
        tip=model.body(tip).id,
        pushed=tuple(model.body(name).id for name in pushed),
        notes=notes,
    )
    model.dof_armature[:] = 0.0
    known = [armature[joint] for joint in joints] if rotor_inertia is None else rotor_inertia
    model.dof_armature[list(dof)] = known
    _set_dofs(plant, parts)
    plant.set_timestep(1e-3)
    return plant


def link_carrying(robot: str | Path, joints: tuple[str, ...], tip: str) -> str:
    """The link moved by one of the joints that a tip is, or is fixed to; "" if there is none."""
    described = read_description(robot)
    moved = {body.name for body in hold_others(described.spec, joints).values()}
    body = described.spec.body(nearest(tip, described.links, "link"))
    while body is not None and body.name not in moved:
        body = body.parent if body.name not in ("world", "") else None
    return "" if body is None else str(body.name)


def changed_inertials(
    described: Description, links: tuple[str, ...], parts: Iterable[Part]
) -> dict[str, Inertial]:
    """Inertial parameters of every link, with those of the parts."""
    inertials = dict(described.inertials)
    changes = [part for part in parts if isinstance(part, LinkChange)]
    for part in sorted(changes, key=lambda change: not change.replace):
        link = nearest(part.link or links[-1], inertials, "link")
        inertials[link] = part.inertial if part.replace else inertials[link] + part.inertial
    return inertials


def unphysical(
    described: Description, links: tuple[str, ...], parts: Iterable[Part]
) -> tuple[str, ...]:
    """Links whose changed figures are no body's."""
    changes = [part for part in parts if isinstance(part, LinkChange)]
    inertials = changed_inertials(described, links, changes)
    changed = dict.fromkeys(change.link or links[-1] for change in changes)
    return tuple(link for link in changed if not inertials[link].is_body)


def tilted(gravity: Vector, tilt: GravityTilt) -> FloatArray:
    """Gravity in the frame of a base rolled by R_x(x) R_y(y), (3,)."""
    (cx, cy), (sx, sy) = np.cos([tilt.x, tilt.y]), np.sin([tilt.x, tilt.y])
    Rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    Ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    return np.asarray((Rx @ Ry).T @ gravity)


def _set_inertials(
    model: Any, described: Description, links: tuple[str, ...], parts: tuple[Part, ...]
) -> tuple[str, ...]:
    changed = {part.link or links[-1] for part in parts if isinstance(part, LinkChange)}
    notes = []
    for name, inertial in changed_inertials(described, links, parts).items():
        if name not in ("world", ""):
            k = model.body(name).id
            if name in changed:
                body = inertial.nearest_body()
                if body is not inertial:
                    notes.append(
                        f"link {name}: its figures are no body's; simulated with the nearest"
                    )
                inertial = body
            moments, axes = inertial.principal(name)
            model.body_mass[k], model.body_inertia[k] = inertial.mass, moments
            model.body_ipos[k] = inertial.com
            quaternion = np.empty(4)
            mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(axes).ravel())
            model.body_iquat[k] = quaternion
    model.body_sameframe[1:] = 0
    return tuple(notes)


def _set_options(model: Any, gravity: Vector, parts: tuple[Part, ...]) -> None:
    option, off = model.opt, mujoco.mjtDisableBit
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.disableflags = off.mjDSBL_CONTACT | off.mjDSBL_AUTORESET
    option.density = option.viscosity = 0.0
    option.wind[:] = 0.0
    option.gravity[:] = gravity
    for part in parts:
        if isinstance(part, GravityTilt):
            option.gravity[:] = tilted(tuple(option.gravity), part)


def _set_dofs(plant: Plant, parts: tuple[Part, ...]) -> None:
    model = plant.model
    motors = np.zeros(model.nv)
    motors[list(plant.dof)] = 1.0
    model.dof_damping[:] *= motors  # the description's
    model.dof_frictionloss[:] *= motors
    model.dof_dampingpoly[:] = 0.0
    model.jnt_stiffness[:] = 0.0
    model.jnt_stiffnesspoly[:] = 0.0
    model.dof_solimp[:] = (0.9999, 0.9999, 1e-3, 0.5, 2.0)
    model.jnt_solimp[:] = (0.99, 0.999, 1e-4, 0.5, 2.0)
    model.eq_solimp[:] = (0.9999, 0.9999, 1e-3, 0.5, 2.0)
    springs: dict[int, tuple[float, float]] = {}
    for part in parts:
        if isinstance(part, DofChange | HardFriction):
            k = plant.dof[plant.joints.index(nearest(part.joint, plant.joints, "joint"))]
        if isinstance(part, DofChange):
            model.dof_damping[k] += part.damping
            model.dof_armature[k] += part.armature
            stiffness, moment = springs.get(k, (0.0, 0.0))
            springs[k] = (stiffness + part.stiffness, moment + part.stiffness * part.rest)
        elif isinstance(part, HardFriction) and isinstance(part.level, float | int):
            model.dof_frictionloss[k] += part.level
    model.dof_frictionloss[:] = np.maximum(model.dof_frictionloss, 0.0)
    model.jnt_limited[:] = 0
    for k, (stiffness, moment) in springs.items():
        model.jnt_stiffness[k] = stiffness
        model.qpos_spring[k] = moment / stiffness if stiffness else 0.0
    _check_inertia(plant)
    _set_gears(plant)
    mujoco.mj_setConst(model, mujoco.MjData(model))


def _check_inertia(plant: Plant) -> None:
    """Each joint must move some inertia; where a motor has none of its own, it gets a share."""
    model = plant.model
    locked = _link_inertia(plant)
    for k, (joint, link) in enumerate(zip(plant.joints, plant.links, strict=True)):
        dof = plant.dof[k]
        if locked[k] + model.dof_armature[dof] < NO_INERTIA:
            heavy = locked[locked > NO_INERTIA]
            least = ROTOR_SHARE * float(np.min(heavy)) if len(heavy) else LONELY_INERTIA
            model.dof_armature[dof] = least
            plant.notes += (
                f"joint {joint} moves no inertia, since link {link} has no mass: simulated with"
                f" {least:.3g} kg m^2",
            )
        if plant.play[k] is not None and model.dof_armature[dof] <= 0.0:
            share = RIGID_ROTOR_SHARE if plant.gears[k].is_rigid else ROTOR_SHARE
            model.dof_armature[dof] = share * locked[k]
            plant.notes += (
                f"{joint}: no rotor inertia is known; its motor is given {share:.0%} of the "
                f"link's, {model.dof_armature[dof]:.3g} kg m^2",
            )


def _link_inertia(plant: Plant) -> FloatArray:
    """The mass matrix' diagonal at zero without armatures, (n,)."""
    model = plant.model
    data = mujoco.MjData(model)
    armature = model.dof_armature.copy()
    model.dof_armature[:] = 1.0
    mujoco.mj_forward(model, data)
    full = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    model.dof_armature[:] = armature
    return (np.diag(full) - 1.0)[list(plant.dof)]


def _set_gears(plant: Plant) -> None:
    model = plant.model
    for k, gear in plant.gears.items():
        dof, play = plant.dof[k], plant.play[k]
        assert play is not None
        model.dof_damping[play] = gear.damping
        if gear.is_rigid:
            continue
        if np.isinf(gear.stiffness):
            model.jnt_limited[play] = 1
            model.jnt_range[play] = (-gear.gap / 2, gear.gap / 2)
            continue
        inverse = 1.0 / model.dof_armature[dof] + 1.0 / _link_inertia(plant)[k]
        stiffest = (STEP_PER_PERIOD / FINEST_STEP) ** 2 / inverse
        stiffness = min(gear.stiffness, stiffest)
        if stiffness < gear.stiffness:  # or sampled control shakes what no spring shakes
            enough = 2.0 * DAMPING_OF_STIFFEST * np.sqrt(stiffness / inverse)
            model.dof_damping[play] = max(gear.damping, float(enough))
        plant.gears[k] = replace(gear, stiffness=stiffness)
        if not gear.gap:
            model.jnt_stiffness[play] = stiffness
        plant.fastest = max(plant.fastest, float(np.sqrt(stiffness * inverse)))
        if stiffness < gear.stiffness:
            plant.notes += (
                f"{gear.joint}: simulated with a spring of {stiffness:.3g} N m/rad, the stiffest "
                f"that steps of {FINEST_STEP:g} s follow, not {gear.stiffness:.3g}",
            )
