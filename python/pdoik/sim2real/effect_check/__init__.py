"""Is an effect what it says of itself? `pdoik effects check` in Python.

Comes in: effects, from a file or the catalogue. Goes out: one `Outcome` per check, with the figure
that was measured and its limit. The arm that it is tried on is made here and simulated as in a
diagnosis.
"""

from .arm import Arm
from .check import check_effect
from .load import load_effects
from .outcome import Outcome

__all__ = [
    "Arm",
    "Outcome",
    "check_effect",
    "load_effects",
]
