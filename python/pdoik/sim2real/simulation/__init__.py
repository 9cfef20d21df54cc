"""Forward simulation of a study's robot in MuJoCo, with parts that findings add."""

from .of_effect import parts_of, unknown_part
from .of_finding import not_simulated, parts_of_finding
from .parts import Part
from .simulator import Simulator
from .stepper import SimulationError, Stepper

__all__ = [
    "Part",
    "SimulationError",
    "Simulator",
    "Stepper",
    "not_simulated",
    "parts_of",
    "parts_of_finding",
    "unknown_part",
]
