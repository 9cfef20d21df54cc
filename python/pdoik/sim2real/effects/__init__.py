"""The physics the diagnosis knows, one file per effect."""

from .actuator_lag import ActuatorLag
from .asymmetric_friction import AsymmetricFriction
from .backlash import Backlash
from .command_delay import CommandDelay
from .coulomb_friction import CoulombFriction
from .effect import Effect, Parameter
from .external_contact import ExternalContact
from .friction_drift import FrictionDrift
from .gravity_direction import GravityDirection
from .inertial import LinkInertials, Payload
from .joint_coupling import JointCoupling
from .joint_elasticity import JointElasticity
from .joint_offset import JointOffset
from .kinematic_error import KinematicError
from .load_dependent_friction import LoadDependentFriction
from .position_dependent_spring import PositionDependentSpring
from .presliding_hysteresis import PreslidingHysteresis
from .rotor_inertia import RotorInertia
from .sensor_gain import SensorGain
from .stribeck_friction import StribeckFriction
from .timestamp_skew import TimestampSkew
from .torque_gain import TorqueGain
from .torque_offset import TorqueOffset
from .torque_ripple import TorqueRipple
from .torque_saturation import TorqueSaturation
from .unknown import Unknown
from .viscous_friction import ViscousFriction

__all__ = ["CATALOGUE", "Effect", "Parameter"]

CATALOGUE: dict[str, Effect] = {
    effect.id: effect
    for effect in (
        ViscousFriction(),
        CoulombFriction(),
        StribeckFriction(),
        AsymmetricFriction(),
        LoadDependentFriction(),
        PreslidingHysteresis(),
        FrictionDrift(),
        RotorInertia(),
        Payload(),
        LinkInertials(),
        GravityDirection(),
        TorqueGain(),
        TorqueOffset(),
        TorqueSaturation(),
        TorqueRipple(),
        PositionDependentSpring(),
        CommandDelay(),
        ActuatorLag(),
        Backlash(),
        JointElasticity(),
        JointOffset(),
        KinematicError(),
        JointCoupling(),
        TimestampSkew(),
        SensorGain(),
        ExternalContact(),
        Unknown(),
    )
}
"""Effects by their id."""
