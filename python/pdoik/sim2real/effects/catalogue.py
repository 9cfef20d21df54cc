"""Every effect by its id: pdoik's own, and those that other packages or users register."""

from __future__ import annotations

import importlib.metadata

from .actuator_lag import ActuatorLag
from .asymmetric_friction import AsymmetricFriction
from .backlash import Backlash
from .command_delay import CommandDelay
from .coulomb_friction import CoulombFriction
from .effect import Effect
from .external_contact import ExternalContact
from .friction_drift import FrictionDrift
from .gear_efficiency import GearEfficiency
from .gravity_direction import GravityDirection
from .ground import FootFriction, FootSoftness, GroundHeight, GroundSlope
from .imu import ImuOffset, ImuTilt
from .inertial import LinkInertials, Payload
from .joint_coupling import JointCoupling
from .joint_elasticity import JointElasticity
from .joint_offset import JointOffset
from .kinematic_error import KinematicError
from .load_dependent_friction import LoadDependentFriction
from .payload_error import PayloadError
from .position_dependent_spring import PositionDependentSpring
from .presliding_hysteresis import PreslidingHysteresis
from .rotor_inertia import RotorInertia
from .sensor_gain import SensorGain
from .sensor_noise import SensorNoise
from .strain_wave_error import StrainWaveError
from .stribeck_friction import StribeckFriction
from .timestamp_skew import TimestampSkew
from .torque_gain import TorqueGain
from .torque_offset import TorqueOffset
from .torque_ripple import TorqueRipple
from .torque_saturation import TorqueSaturation
from .torque_speed_limit import TorqueSpeedLimit
from .unknown import Unknown
from .viscous_friction import ViscousFriction

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
