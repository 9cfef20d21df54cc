"""Every effect's id, how it is drawn, how it can be hidden, and a campaign of all of it."""

from collections.abc import Callable, Iterator
from functools import partial

from bench.sim2real.concealed import effects_body as body
from bench.sim2real.concealed import effects_drive as drive
from bench.sim2real.concealed import effects_friction as friction
from bench.sim2real.concealed import effects_late as late
from bench.sim2real.concealed import effects_sensor as sensor
from bench.sim2real.concealed import effects_transmission as transmission
from bench.sim2real.concealed.effect import Effect, Scene
from bench.sim2real.concealed.effects_outside import KINDS
from bench.sim2real.concealed.effects_sensor import LIES
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.robots import NAMES

EFFECTS: dict[str, Callable[[Scene], Effect]] = {
    "viscous_friction": friction.viscous,
    "coulomb_friction": friction.coulomb,
    "stribeck_friction": friction.stribeck,
    "asymmetric_friction": friction.asymmetric,
    "load_dependent_friction": friction.load_dependent,
    "presliding_hysteresis": friction.presliding,
    "friction_drift": friction.drift,
    "rotor_inertia": body.rotor,
    "payload": body.payload,
    "link_inertial_error": body.link_error,
    "gravity_direction": body.gravity,
    "external_contact": body.contact,
    "torque_gain": partial(drive.by_drive_or_sensor, make=drive.TorqueGain),
    "torque_offset": partial(drive.by_drive_or_sensor, make=drive.TorqueOffset),
    "torque_saturation": drive.saturation,
    "torque_ripple": drive.ripple,
    "position_dependent_spring": drive.spring,
    "command_delay": late.delay,
    "actuator_lag": late.lag,
    "backlash": transmission.backlash,
    "joint_elasticity": transmission.elasticity,
    "joint_offset": transmission.joint_offset,
    "kinematic_error": transmission.kinematic_error,
    "joint_coupling": transmission.coupling,
    "timestamp_skew": sensor.skew,
    "sensor_gain": sensor.sensor_gain,
    "sensor_noise": sensor.sensor_noise,
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
    *("external_contact", "timestamp_skew", "sensor_noise"),
    *("torque_offset", "command_delay", "actuator_lag"),
)
WITH_TIP = {"kinematic_error": 1.0, "joint_offset": 0.6} | dict.fromkeys(
    ("joint_coupling", "backlash", "joint_elasticity"), 0.5
)
"""How often the log holds tip poses, where it is not one in ten."""


def ways_of(effect: str) -> tuple[str, ...]:
    """The ways in which an effect can be hidden."""
    return tuple(
        way
        for way in WAYS
        if not (way == "corner" and effect not in CORNERS)
        and not (way == "no_torque" and effect in UNSEEN_WITHOUT_TORQUE)
        and not (way == "poor" and effect in NOT_OF_EXCITATION)
    )


CLEAN = ("plain", "plain", "feedback", "plain", "no_torque")  # ways in which nothing is hidden


def campaign(
    first_seed: int,
    *,
    plain: int = 5,
    per_way: int = 2,
    clean: int = 100,
    outside: int = 6,
    lying: int = 6,
    still: int = 20,
) -> Iterator[WorldSpec]:
    """Specs with seeds that count up from `first_seed`; robots take turns.

    `plain`, `per_way`, `outside` and `lying` are numbers per effect or kind.
    """
    plans: list[tuple[str, str]] = []
    for effect in EFFECTS:
        for way in ways_of(effect):
            plans += [(effect, way)] * (plain if way == "plain" else per_way)
    plans += [("clean", CLEAN[k % len(CLEAN)]) for k in range(clean)]
    plans += [(f"outside:{kind}", "plain") for kind in KINDS for _ in range(outside)]
    plans += [(f"lying:{kind}", "plain") for kind in LIES for _ in range(lying)]
    plans += [("still", "plain")] * still
    for index, (effect, way) in enumerate(plans):
        robot = NAMES[(7 * index + index // len(NAMES)) % len(NAMES)]
        yield WorldSpec(seed=first_seed + index, effect=effect, hide=way, robot=robot)
