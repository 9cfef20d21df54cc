"""Everything of one study that is decided before anything moves, ways of hiding with it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from bench.sim2real.concealed.catalogue import CORNERS, EFFECTS, WAYS, WITH_TIP, ways_of
from bench.sim2real.concealed.effect import Gate
from bench.sim2real.concealed.effects_outside import slosh
from bench.sim2real.concealed.equipment import Controller, Sensors, controller, rotors, sensors
from bench.sim2real.concealed.reference import Reference, reference
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.arm import Arm, Array, Link
from bench.sim2real.frame.motion import Motion, Style, center, recording_motion
from bench.sim2real.frame.robots import robot


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """All of it."""

    spec: WorldSpec
    plan: Plan
    arm: Arm  # without effects, truly
    believed: Arm  # as the URDF says
    armature: Array
    roles: list[str]
    motions: list[Motion]
    ref: Reference
    control: Controller
    sensors: Sensors


def draft_of(spec: WorldSpec) -> Draft:
    arm = robot(spec.robot, spec.stream("robot"))
    if spec.effect == "outside:slosh":  # the load is known, its swinging is not
        load = slosh(arm, spec.stream("slosh")).load()
        arm = arm.with_link(arm.n - 1, arm.links[-1].plus(load))
    todo = plan(spec, arm)
    armature = rotors(arm, spec.stream("rotors"))
    believed = misjudged(arm, todo.model_error, spec.stream("model"))
    haste = 1.0
    for _ in range(6):  # slower until the drives could bear it
        ref = reference(believed, armature, _motions(spec, arm, Style(), haste)[1])
        if np.all(np.abs(ref.tau) < 0.8 * arm.efforts):
            break
        haste *= 0.8
    roles, motions = _motions(spec, arm, todo.style, haste)
    if todo.style.slow:
        ref = reference(believed, armature, motions)
    equipment = spec.stream("equipment")
    control = controller(ref, equipment, tight=todo.tight, soft=todo.soft)
    sense = sensors(ref, control, equipment)
    tip = spec.stream("tip").random() < WITH_TIP.get(spec.effect, 0.1)
    if spec.effect in ("timestamp_skew", "sensor_gain", "sensor_noise", "lying:dq_scaled"):
        sense = replace(sense, dq=True)
    return Draft(
        spec=spec,
        plan=todo,
        arm=arm,
        believed=believed,
        armature=armature,
        roles=roles,
        motions=motions,
        ref=ref,
        control=control,
        sensors=replace(sense, tip=bool(tip)),
    )


def _motions(
    spec: WorldSpec, arm: Arm, style: Style, haste: float
) -> tuple[list[str], list[Motion]]:
    rng = spec.stream("motions")
    plans = [
        ("fit", ("sines", "reversals"), 1.0),
        ("fit", ("moves", "sines"), 0.8),
        ("validate", ("reversals", "sines", "fast_moves"), 1.15),
    ]
    if spec.effect == "torque_saturation":  # a limit that no recording to fit reaches teaches none
        plans[1] = ("fit", ("fast_moves", "reversals", "fast_moves"), 1.2)
    if rng.random() < 0.3:
        plans.append(("validate", ("moves", "reversals"), 0.7))
    order = rng.permutation(len(plans))
    motions = []
    for k in order:
        _, kinds, pace = plans[k]
        duration = float(np.round(rng.uniform(20.0, 28.0)))
        pace *= haste * rng.uniform(0.85, 1.15)
        motions.append(recording_motion(arm, rng, kinds, duration, pace, style))
    return [plans[k][0] for k in order], motions


OF_THE_BODY = (  # what errors of the model's inertias look like
    *("payload", "link_inertial_error", "gravity_direction", "rotor_inertia", "torque_gain"),
    *("torque_offset", "joint_offset", "position_dependent_spring", "joint_coupling"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How one study hides its effect."""

    places: tuple[int, ...]  # in random order; one only where the motion was made for it
    size: float
    gate: Gate
    style: Style
    corner: str
    tight: bool
    soft: bool  # a controller that bears late torques
    torque_logged: bool
    model_error: float  # relative, of all inertial figures


def plan(spec: WorldSpec, arm: Arm) -> Plan:
    """Checked, and drawn from the spec's own stream."""
    rng = spec.stream("hide")
    effect, way = spec.effect, spec.hide
    if way not in WAYS:
        raise ValueError(f"hide is {way!r}, expected one of {', '.join(WAYS)}")
    if effect in EFFECTS and way not in ways_of(effect):
        known = ", ".join(ways_of(effect))
        raise ValueError(f"hide is {way!r}, expected one of {known} for {effect}")
    places = tuple(int(j) for j in rng.permutation(arm.n))
    corner = str(rng.choice(CORNERS[effect])) if way == "corner" and effect in CORNERS else ""
    style, gate = Style(), Gate()
    if corner == "slow":
        places = places[:1]
        style = Style(slow=frozenset(places))
    elif corner == "position":
        gate = Gate(kind="position", low=float(rng.choice([0.0, 0.1, 0.65, 0.75])))
    elif corner == "time":
        gate = Gate(kind="time", low=float(np.round(rng.uniform(13.0, 15.5), 1)), high=1e9)
    if effect == "still" or way == "poor":
        places = places[:1]
        style = _still(spec, arm, places)
        if effect in OF_THE_BODY[:3] or effect in ("kinematic_error", "joint_offset"):
            style = _still(spec, arm, range(arm.n))
    low, high = (2.0, 3.5) if way == "noise" else (6.0, 25.0)
    size = spec.size or float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return Plan(
        places=places,
        size=size,
        gate=gate,
        style=style,
        corner=corner,
        tight=way == "feedback",
        soft=way != "feedback" and rng.random() < (0.6 if effect == "actuator_lag" else 0.1),
        torque_logged=way != "no_torque",
        model_error=0.05 if way == "inertia" else 0.0,
    )


def _still(spec: WorldSpec, arm: Arm, joints: Iterable[int]) -> Style:
    pose = center(arm, spec.stream("pose"))[0]
    return Style(still={j: float(pose[j]) for j in joints})


def misjudged(arm: Arm, error: float, rng: np.random.Generator) -> Arm:
    """The arm with every link's mass, centre of mass and inertia wrong by about `error`."""
    if error == 0.0:
        return arm
    for k, link in enumerate(arm.links):
        mass = link.mass * (1.0 + error * rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2))
        com = link.com * (1.0 + error * rng.choice([-1.0, 1.0], 3) * rng.uniform(0.6, 1.2, 3))
        # second moments scale along each axis, so the inertia stays that of a body
        second = 0.5 * np.trace(link.inertia) * np.eye(3) - link.inertia
        scale = np.diag(np.sqrt(1.0 + error * rng.uniform(-1.2, 1.2, 3)))
        second = scale @ second @ scale
        inertia = np.trace(second) * np.eye(3) - second
        arm = arm.with_link(k, Link(mass=mass, com=com, inertia=inertia))
    return arm
