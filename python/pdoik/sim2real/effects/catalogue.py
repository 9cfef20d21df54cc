"""Every effect by its id: pdoik's own, and those that other packages or users register."""

from __future__ import annotations

import importlib.metadata

from .bodies.gravity_direction import GravityDirection
from .bodies.inertial import LinkInertials, Payload
from .bodies.kinematic_error import KinematicError
from .bodies.payload_error import PayloadError
from .contacts.external_contact import ExternalContact
from .contacts.ground import FootFriction, FootSoftness, GroundHeight, GroundSlope
from .drives.actuator_lag import ActuatorLag
from .drives.command_delay import CommandDelay
from .drives.torque_gain import TorqueGain
from .drives.torque_offset import TorqueOffset
from .drives.torque_saturation import TorqueSaturation
from .drives.torque_speed_limit import TorqueSpeedLimit
from .effect import Effect
from .friction.asymmetric_friction import AsymmetricFriction
from .friction.coulomb_friction import CoulombFriction
from .friction.friction_drift import FrictionDrift
from .friction.load_dependent_friction import LoadDependentFriction
from .friction.presliding_hysteresis import PreslidingHysteresis
from .friction.stribeck_friction import StribeckFriction
from .friction.viscous_friction import ViscousFriction
from .sensors.imu import ImuOffset, ImuTilt
from .sensors.joint_offset import JointOffset
from .sensors.sensor_gain import SensorGain
from .sensors.sensor_noise import SensorNoise
from .sensors.timestamp_skew import TimestampSkew
from .transmission.backlash import Backlash
from .transmission.gear_efficiency import GearEfficiency
from .transmission.joint_coupling import JointCoupling
from .transmission.joint_elasticity import JointElasticity
from .transmission.position_dependent_spring import PositionDependentSpring
from .transmission.rotor_inertia import RotorInertia
from .transmission.strain_wave_error import StrainWaveError
from .transmission.torque_ripple import TorqueRipple
from .unknown import Unknown

GROUP = "pdoik.effects"
"""Entry points of this group are classes of effects, or instances."""

CATALOGUE: dict[str, Effect] = {}
"""Effects by their id."""


def register(effect: Effect | type[Effect]) -> Effect:
    """Add an effect to the catalogue, so that it is tried, simulated, listed and reported.

    Args:
        effect: an instance, or a class that needs no arguments.

    Raises:
        ValueError: it has no id, or that of another effect.
    """
    made = effect() if isinstance(effect, type) else effect
    name = getattr(made, "id", "")
    if not name:
        raise ValueError(f"{type(made).__name__} has no id, expected a name such as 'stiction'")
    if name in CATALOGUE and type(CATALOGUE[name]) is not type(made):
        raise ValueError(f"there is another effect {name!r}: {type(CATALOGUE[name]).__name__}")
    CATALOGUE[name] = made
    return made


def known(effect: str) -> Effect:
    """The effect of an id.

    Raises:
        ValueError: there is none.
    """
    if effect not in CATALOGUE:
        raise ValueError(f"no effect {effect!r}, expected one of {', '.join(CATALOGUE)}")
    return CATALOGUE[effect]


for _effect in (
    ViscousFriction(),
    CoulombFriction(),
    StribeckFriction(),
    AsymmetricFriction(),
    LoadDependentFriction(),
    GearEfficiency(),
    PreslidingHysteresis(),
    FrictionDrift(),
    RotorInertia(),
    Payload(),
    PayloadError(),
    LinkInertials(),
    GravityDirection(),
    ImuTilt(),
    ImuOffset(),
    GroundHeight(),
    GroundSlope(),
    FootSoftness(),
    FootFriction(),
    TorqueGain(),
    TorqueOffset(),
    TorqueSaturation(),
    TorqueSpeedLimit(),
    TorqueRipple(),
    PositionDependentSpring(),
    CommandDelay(),
    ActuatorLag(),
    Backlash(),
    JointElasticity(),
    JointOffset(),
    KinematicError(),
    StrainWaveError(),
    JointCoupling(),
    TimestampSkew(),
    SensorGain(),
    SensorNoise(),
    ExternalContact(),
    Unknown(),
):
    register(_effect)

for _entry in importlib.metadata.entry_points(group=GROUP):
    register(_entry.load())
