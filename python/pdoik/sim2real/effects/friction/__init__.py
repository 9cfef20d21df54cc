"""What rubs in a joint."""

from .asymmetric_friction import AsymmetricFriction
from .coulomb_friction import CoulombFriction
from .friction_drift import FrictionDrift
from .load_dependent_friction import LoadDependentFriction
from .presliding_hysteresis import PreslidingHysteresis, bristle
from .stribeck_friction import StribeckFriction
from .viscous_friction import ViscousFriction

__all__ = [
    "AsymmetricFriction",
    "CoulombFriction",
    "FrictionDrift",
    "LoadDependentFriction",
    "PreslidingHysteresis",
    "StribeckFriction",
    "ViscousFriction",
    "bristle",
]
