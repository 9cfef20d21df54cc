"""Everything of one study that is decided before anything moves."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.sim2real.concealed import draw_decoys
from bench.sim2real.concealed.arm import Arm, Array
from bench.sim2real.concealed.catalogue import WITH_TIP
from bench.sim2real.concealed.equipment import Controller, Sensors, controller, rotors, sensors
from bench.sim2real.concealed.hide import Plan, misjudged, plan
from bench.sim2real.concealed.motion import Motion, Style, recording_motion
from bench.sim2real.concealed.reference import Reference, reference
from bench.sim2real.concealed.robots import robot
from bench.sim2real.concealed.spec import WorldSpec


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """Everything decided before anything moves."""

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
    """Draws it all."""
    arm = robot(spec.robot, spec.stream("robot"))
    if spec.effect == "outside:slosh":  # the load is known, its swinging is not
        load = draw_decoys.slosh(arm, spec.stream("slosh")).load()
        arm = arm.with_link(arm.n - 1, arm.links[-1].plus(load))
    todo = plan(spec, arm)
    armature = rotors(arm, spec.stream("rotors"))
    believed = misjudged(arm, todo.model_error, spec.stream("model"))
    efforts = np.array([joint.effort for joint in arm.joints])
    haste = 1.0
    for _ in range(6):  # slower until the drives could bear it
        ref = reference(believed, armature, _motions(spec, arm, Style(), haste)[1])
        if np.all(np.abs(ref.tau) < 0.8 * efforts):
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
