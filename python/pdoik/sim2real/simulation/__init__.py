"""Forward simulation of a robot in MuJoCo, with parts that a description has no words for.

Comes in: a robot's description, a controller, parts (`parts.py`). Goes out: recordings of what it
would do for given commands. Knows nothing of effects or findings.
"""

from .parts import Part
from .simulator import Simulator
from .stepper import SimulationError, Stepper

__all__ = ["Part", "SimulationError", "Simulator", "Stepper"]
