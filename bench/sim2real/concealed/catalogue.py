"""Every effect's id, how it is drawn, and the ways of hiding that make sense for it."""

from __future__ import annotations

from collections.abc import Callable

from bench.sim2real.concealed import draw_body, draw_drive, draw_friction, draw_transmission
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.scene import Scene

EFFECTS: dict[str, Callable[[Scene], Effect]] = {
    "viscous_friction": draw_friction.viscous,
    "coulomb_friction": draw_friction.coulomb,
    "stribeck_friction": draw_friction.stribeck,
    "asymmetric_friction": draw_friction.asymmetric,
    "load_dependent_friction": draw_friction.load_dependent,
    "presliding_hysteresis": draw_friction.presliding,
    "friction_drift": draw_friction.drift,
    "rotor_inertia": draw_body.rotor,
    "payload": draw_body.payload,
    "link_inertial_error": draw_body.link_error,
    "gravity_direction": draw_body.gravity,
    "external_contact": draw_body.contact,
    "torque_gain": draw_drive.gain,
    "torque_offset": draw_drive.offset,
    "torque_saturation": draw_drive.saturation,
    "torque_ripple": draw_drive.ripple,
    "position_dependent_spring": draw_drive.spring,
    "command_delay": draw_drive.delay,
    "actuator_lag": draw_drive.lag,
    "backlash": draw_transmission.backlash,
    "joint_elasticity": draw_transmission.elasticity,
    "joint_offset": draw_transmission.joint_offset,
    "kinematic_error": draw_transmission.kinematic_error,
    "joint_coupling": draw_transmission.coupling,
    "timestamp_skew": draw_transmission.skew,
    "sensor_gain": draw_transmission.sensor_gain,
    "sensor_noise": draw_transmission.sensor_noise,
}

WAYS = ("plain", "feedback", "noise", "second", "corner", "no_torque", "inertia", "poor")

CORNERS: dict[str, tuple[str, ...]] = {
    "viscous_friction": ("position", "time"),
    "coulomb_friction": ("position", "slow", "time"),
    "stribeck_friction": ("slow",),
    "asymmetric_friction": ("slow",),
    "load_dependent_friction": ("slow", "time"),
    "presliding_hysteresis": ("slow", "position"),
    "external_contact": ("own",),
    "torque_gain": ("time",),
    "torque_offset": ("time",),
    "torque_saturation": ("own",),
    "torque_ripple": ("position", "time"),
    "position_dependent_spring": ("own",),
}

UNSEEN_WITHOUT_TORQUE = ("timestamp_skew", "actuator_lag")
NOT_OF_EXCITATION = (
    "external_contact",
    "timestamp_skew",
    "sensor_noise",
    "torque_offset",
    "command_delay",
    "actuator_lag",
)
WITH_TIP = {
    "kinematic_error": 1.0,
    "joint_offset": 0.6,
    "joint_coupling": 0.5,
    "backlash": 0.5,
    "joint_elasticity": 0.5,
}


def ways_of(effect: str) -> tuple[str, ...]:
    """The ways in which an effect can be hidden."""
    ways = [
        way
        for way in WAYS
        if not (way == "corner" and effect not in CORNERS)
        and not (way == "no_torque" and effect in UNSEEN_WITHOUT_TORQUE)
        and not (way == "poor" and effect in NOT_OF_EXCITATION)
    ]
    return tuple(ways)
