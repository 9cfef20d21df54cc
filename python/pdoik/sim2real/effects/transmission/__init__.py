"""What is between a motor and its link: rotors, gears, springs, play."""

from .backlash import Backlash, swing
from .gear_efficiency import GearEfficiency
from .joint_coupling import JointCoupling
from .joint_elasticity import JointElasticity, given_way
from .position_dependent_spring import PositionDependentSpring
from .rotor_inertia import RotorInertia
from .strain_wave_error import StrainWaveError
from .torque_ripple import TorqueRipple

__all__ = [
    "Backlash",
    "GearEfficiency",
    "JointCoupling",
    "JointElasticity",
    "PositionDependentSpring",
    "RotorInertia",
    "StrainWaveError",
    "TorqueRipple",
    "given_way",
    "swing",
]
