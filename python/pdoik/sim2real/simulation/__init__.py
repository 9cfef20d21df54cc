"""Forward simulation of a study's robot in MuJoCo, with parts that findings add."""

from .of_finding import parts_of, parts_of_finding, unknown_part
from .parts import Part
from .simulator import Simulator
from .stepper import SimulationError, Stepper

__all__ = [
    "Part",
    "SimulationError",
    "Simulator",
    "Stepper",
    "parts_of",
    "parts_of_finding",
    "unknown_part",
]
