"""Forward simulation of a robot in MuJoCo, with parts that a description has no words for.

Comes in: a robot's description, a controller, parts (`parts.py`). Goes out: recordings of what it
would do for given commands. Knows nothing of effects or findings.
"""

from .assemble import HINGE
from .control import GravityModel
from .description import Description, nearest, read_description
from .drift_reset import SHIFTED, TURNED
from .drive import Drive, combine
from .inertial import Inertial
from .laws import (
    Dahl,
    GatedMemory,
    Variable,
    constant,
    curve,
    cycle,
    drift,
    gated,
    level_asymmetry,
    of_driven_load,
    of_load,
    of_speed,
    ripple,
    smooth_sign,
    spring,
    stribeck,
    viscous_asymmetry,
)
from .mjcf import flat_mjcf, mjcf_text, movable_joints, odd_inertias
from .parts import (
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
    StatefulLaw,
    Vector,
    Wave,
)
from .plant import STANDARD_GRAVITY, build_plant, changed_inertials, link_carrying, unphysical
from .segments import measured_state
from .simulator import OPEN_LOOP_WINDOW, DrivenBy, Simulator
from .stepper import SimulationError, Stepper

__all__ = [
    "HINGE",
    "OPEN_LOOP_WINDOW",
    "SHIFTED",
    "STANDARD_GRAVITY",
    "TURNED",
    "Coupling",
    "Dahl",
    "Description",
    "DofChange",
    "Drive",
    "DriveChange",
    "DrivenBy",
    "ExternalForce",
    "GatedMemory",
    "GearPlay",
    "GravityModel",
    "GravityTilt",
    "HardFriction",
    "Inertial",
    "JointTorque",
    "Law",
    "LinkChange",
    "Part",
    "Placement",
    "SensedChannel",
    "SensorChange",
    "SimulationError",
    "Simulator",
    "StatefulLaw",
    "Stepper",
    "Variable",
    "Vector",
    "Wave",
    "build_plant",
    "changed_inertials",
    "combine",
    "constant",
    "curve",
    "cycle",
    "drift",
    "flat_mjcf",
    "gated",
    "level_asymmetry",
    "link_carrying",
    "measured_state",
    "mjcf_text",
    "movable_joints",
    "nearest",
    "odd_inertias",
    "of_driven_load",
    "of_load",
    "of_speed",
    "read_description",
    "ripple",
    "smooth_sign",
    "spring",
    "stribeck",
    "unphysical",
    "viscous_asymmetry",
]
