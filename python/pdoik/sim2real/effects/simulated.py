"""How each effect enters the simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from ..simulation.inertial import Inertial
from ..simulation.laws import (
    Dahl,
    Variable,
    curve,
    cycle,
    drift,
    level_asymmetry,
    of_load,
    of_speed,
    ripple,
    smooth_sign,
    spring,
    stribeck,
    viscous_asymmetry,
)
from ..simulation.parts import (
    Coupling,
    DofChange,
    DriveChange,
    ExternalForce,
    GearPlay,
    GravityTilt,
    HardFriction,
    JointTorque,
    Law,
    LinkChange,
    Part,
    Placement,
    SensedChannel,
    SensorChange,
)
from .unknown import BEYOND
from .unknown import VARIABLES as DEPENDS

CHANNELS: dict[str, SensedChannel] = {"position": "q", "speed": "dq", "torque": "tau"}
"""By an effect's variant."""
LOGGED = "logged "
"""Begins the variant of what is wrong in the log alone."""

INERTIAS = ("ixx", "ixy", "iyy", "ixz", "iyz", "izz")  # Pinocchio's order


@dataclass(frozen=True, slots=True)
class _Where:
    """Where an effect is, and how large."""

    joints: tuple[str, ...]
    links: tuple[str, ...]
    window: tuple[float, float] | None
    recordings: tuple[str, ...]
    variant: str
    values: Mapping[str, float]

    def __getitem__(self, parameter: str) -> float:
        return float(self.values[parameter])

    def get(self, parameter: str) -> float:
        return float(self.values.get(parameter, 0.0))

    def channel(self, default: SensedChannel) -> SensedChannel:
        return CHANNELS.get(self.variant.removeprefix(LOGGED), default)

    @property
    def link(self) -> str:
        return self.links[0] if self.links else ""

    def each(self, make: Callable[[str], Part]) -> tuple[Part, ...]:
        return tuple(make(joint) for joint in self.joints)


def parts_of(
    effect: str,
    joints: Sequence[str],
    links: Sequence[str] = (),
    window: tuple[float, float] | None = None,
    values: Mapping[str, float] = {},
    *,
    recordings: Sequence[str] = (),
    variant: str = "",
) -> tuple[Part, ...]:
    """What an effect adds to the simulation.

    Args:
        effect: Its id, such as "coulomb_friction".
        joints: It acts on each; of joint_coupling the moved one, then the one whose motor moves it;
            of unknown the joint, then the one it depends on if another.
        links: For payload and contact; the last joint's if there is none.
        window: Of external_contact [s].
        values: Its parameters by name.
        recordings: Where external_contact acts; () for all.
        variant: What sensor_gain (of speed unless it says position or torque; `logged speed` and
            `logged position` where the controller reads them right), timestamp_skew (of
            torque), command_delay and actuator_lag (of torque or position) are of; whether
            torque_gain and torque_offset are those of the report or the drive, or "" of both.

    Raises:
        ValueError: there is no such effect, or a parameter is missing.
    """
    if effect not in EFFECTS:
        raise ValueError(f"no effect {effect!r}, expected one of {', '.join(EFFECTS)}")
    where = _Where(tuple(joints), tuple(links), window, tuple(recordings), variant, values)
    try:
        return EFFECTS[effect](where)
    except KeyError as error:
        raise ValueError(
            f"{effect} needs the parameter {error}, got {', '.join(values) or 'none'}"
        ) from None


def _asymmetric(w: _Where) -> tuple[Part, ...]:
    level, viscous = w.get("level_difference"), w.get("viscous_difference")
    return w.each(lambda j: HardFriction(joint=j, level=level_asymmetry(level))) + w.each(
        lambda j: JointTorque(joint=j, law=viscous_asymmetry(viscous))
    )


def _spring(w: _Where) -> tuple[Part, ...]:
    stiffness, onset, side = w["stiffness"], w.get("onset"), w.get("side")
    if side == 0:
        return w.each(lambda j: DofChange(joint=j, stiffness=stiffness, rest=onset))
    return w.each(lambda j: JointTorque(joint=j, law=spring(stiffness, onset, side), at_link=True))


def _payload(w: _Where) -> tuple[Part, ...]:
    com = np.array([w.get("com_x"), w.get("com_y"), w.get("com_z")])
    about_com = Inertial.from_ten([0.0] * 4 + [w.get(name) for name in INERTIAS]).inertia
    return (LinkChange(link=w.link, inertial=Inertial.about_com(w["mass"], com, about_com)),)


def _link_error(w: _Where) -> tuple[Part, ...]:
    names = ["d_mass", *(f"d_first_moment_{axis}" for axis in "xyz"), *(f"d_{i}" for i in INERTIAS)]
    return (LinkChange(link=w.link, inertial=Inertial.from_ten([w.get(name) for name in names])),)


def _kinematic_error(w: _Where) -> tuple[Part, ...]:
    moved = (w.get("dx"), w.get("dy"), w.get("dz"))
    turned = (w.get("rx"), w.get("ry"), w.get("rz"))
    return w.each(lambda j: Placement(joint=j, shift=moved, rotation=turned))


def _coupling(w: _Where) -> tuple[Part, ...]:
    if len(w.joints) != 2:
        raise ValueError(f"joint_coupling needs two joints, got {', '.join(w.joints) or 'none'}")
    return (Coupling(joint=w.joints[0], by=w.joints[1], ratio=w["ratio"]),)


def _contact(w: _Where) -> tuple[Part, ...]:
    force = (w.get("force_x"), w.get("force_y"), w.get("force_z"))
    push = ExternalForce(link=w.link, force=force, window=w.window, recordings=w.recordings)
    return (replace(push, at_origin=w.variant == "origin"),)


def _torque_gain(w: _Where) -> tuple[Part, ...]:
    gain = w["gain"]
    if w.variant == "report":
        return w.each(lambda j: SensorChange(joint=j, channel="tau", gain=gain))
    if w.variant == "drive":
        return w.each(lambda j: DriveChange(joint=j, command_gain=gain))
    return w.each(lambda j: DriveChange(joint=j, gain=gain))


def _torque_offset(w: _Where) -> tuple[Part, ...]:
    offset = w["offset"]
    if w.variant == "report":
        return w.each(lambda j: SensorChange(joint=j, channel="tau", offset=-offset))
    if w.variant == "drive":
        return w.each(lambda j: DriveChange(joint=j, command_offset=offset))
    return w.each(lambda j: DriveChange(joint=j, offset=offset))


def _delay(w: _Where) -> tuple[Part, ...]:
    if w.variant == "torque":
        return w.each(lambda j: DriveChange(joint=j, torque_delay=w["delay"]))
    lag = w.get("time_constant")  # of a servo of which positions alone are known
    return w.each(lambda j: DriveChange(joint=j, delay=w["delay"], command_lag=lag))


def _lag(w: _Where) -> tuple[Part, ...]:
    if w.variant == "position":
        return w.each(lambda j: DriveChange(joint=j, command_lag=w["time_constant"]))
    return w.each(lambda j: DriveChange(joint=j, time_constant=w["time_constant"]))


def _unknown(w: _Where) -> tuple[Part, ...]:
    """A torque by its values at even knots of a variable, as the effect `unknown` has it."""
    depends, joint = depends_on(w.values), w.joints[0]
    if depends == "nothing":
        return ()
    low, high = w["lowest"], w["highest"]
    values = [w[f"value_{k}"] for k in range(sum(each.startswith("value_") for each in w.values))]
    if depends == "clock":
        law = cycle(low, values[0], values[1])
        return (JointTorque(joint=joint, law=law, by_clock=True),)
    if depends in ("position and speed", "fine position and speed"):
        count = len(values) // 2
        knots, levels = _prolonged(low, high, values[:count])
        level = curve("position", knots, levels)
        slope = curve("position", *_prolonged(low, high, values[count:]))
        return (
            _dry(joint, level, min(levels)),
            JointTorque(joint=joint, law=of_speed(slope)),
        )
    if depends not in SIMULATED_UNKNOWN:
        return ()
    variable = cast(Variable, depends.removeprefix("other ").removeprefix("fine "))
    knots, values = _prolonged(low, high, values)
    return (unknown_part(joint, variable, knots, values, of=w.joints[-1]),)


def _prolonged(low: float, high: float, values: list[float]) -> tuple[list[float], list[float]]:
    """Even knots and values, the outermost lines going on as those of the effect do."""
    knots = np.linspace(low, high, len(values)).tolist()
    if len(values) < 2:
        return knots, values
    more, steps = BEYOND * (high - low), BEYOND * (len(values) - 1)
    first = values[0] - steps * (values[1] - values[0])
    last = values[-1] + steps * (values[-1] - values[-2])
    return [low - more, *knots, high + more], [first, *values, last]


def depends_on(values: Mapping[str, float]) -> str:
    """On what an unnamed torque depends; "nothing" where that is not known."""
    return DEPENDS[int(values["variable"])] if "variable" in values else "nothing"


SIMULATED_UNKNOWN = (
    "position",
    "fine position",
    "speed",
    "load",
    "time",
    "position and speed",
    "fine position and speed",
    "other position",
    "other speed",
    "clock",
)
"""Torques that a law of one joint can be: a loaded neighbour's, or what is left, cannot."""


def _dry(joint: str, level: Law, lowest: float) -> Part:
    """Friction of a level that varies; where it may be negative, smooth and without sticking."""
    if lowest >= 0.0:
        return HardFriction(joint=joint, level=level)
    return JointTorque(joint=joint, law=smooth_sign(level))


def unknown_part(
    joint: str, variable: Variable, knots: Sequence[float], values: Sequence[float], of: str = ""
) -> JointTorque:
    """A torque without a name as straight lines over a variable (of another joint, if `of`)."""
    law = curve(variable, knots, values)
    return JointTorque(joint=joint, law=law, of=of, needs_load=variable == "load")


EFFECTS: dict[str, Callable[[_Where], tuple[Part, ...]]] = {
    "viscous_friction": lambda w: w.each(lambda j: DofChange(joint=j, damping=w["coefficient"])),
    "coulomb_friction": lambda w: w.each(lambda j: HardFriction(joint=j, level=w["level"])),
    "stribeck_friction": lambda w: w.each(
        lambda j: HardFriction(joint=j, level=stribeck(w["extra"], w["speed"]))
    ),
    "asymmetric_friction": _asymmetric,
    "load_dependent_friction": lambda w: w.each(
        lambda j: HardFriction(joint=j, level=of_load(w["coefficient"]), needs_load=True)
    ),
    "presliding_hysteresis": lambda w: w.each(
        lambda j: JointTorque(joint=j, law=Dahl(w["level"], w["displacement"]))
    ),
    "friction_drift": lambda w: w.each(
        lambda j: HardFriction(joint=j, level=drift(w["extra"], w["time_constant"]))
    ),
    "rotor_inertia": lambda w: w.each(lambda j: DofChange(joint=j, armature=w["inertia"])),
    "payload": _payload,
    "link_inertial_error": _link_error,
    "gravity_direction": lambda w: (GravityTilt(x=w.get("tilt_x"), y=w.get("tilt_y")),),
    "torque_gain": _torque_gain,
    "torque_offset": _torque_offset,
    "torque_saturation": lambda w: w.each(lambda j: DriveChange(joint=j, limit=w["level"])),
    "torque_ripple": lambda w: w.each(
        lambda j: JointTorque(joint=j, law=ripple(w["amplitude"], w.get("phase"), w["harmonic"]))
    ),
    "position_dependent_spring": _spring,
    "command_delay": _delay,
    "actuator_lag": _lag,
    "backlash": lambda w: w.each(lambda j: GearPlay(joint=j, gap=w["gap"])),
    "joint_elasticity": lambda w: w.each(
        lambda j: GearPlay(joint=j, stiffness=w["stiffness"], damping=w.get("damping"))
    ),
    "joint_offset": lambda w: w.each(
        lambda j: SensorChange(joint=j, channel="q", offset=w["offset"])
    ),
    "kinematic_error": _kinematic_error,
    "joint_coupling": _coupling,
    "timestamp_skew": lambda w: w.each(
        lambda j: SensorChange(joint=j, channel=w.channel("tau"), skew=w["skew"])
    ),
    "sensor_gain": lambda w: w.each(
        lambda j: SensorChange(
            joint=j,
            channel=w.channel("dq"),
            gain=w["gain"],
            log_only=w.variant.startswith(LOGGED),
        )
    ),
    "sensor_noise": lambda w: (),
    "external_contact": _contact,
    "unknown": _unknown,
}
