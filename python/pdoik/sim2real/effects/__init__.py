"""The physics the diagnosis knows, one file per effect.

An effect owns itself: equation, parameters and bounds, columns in the balances, its part in a
simulation, what it is confused with, its words. Everything else asks `CATALOGUE`. Another one is a
file like these, registered by `register` or an entry point of the group `pdoik.effects`.
"""

from .catalogue import CATALOGUE, known, register
from .effect import Effect, Example, Parameter
from .simulated import not_simulated, parts_of, parts_of_finding
from .site import Site
from .unknown import VARIABLES, Unknown, hats, unknown_part

__all__ = [
    "CATALOGUE",
    "VARIABLES",
    "Effect",
    "Example",
    "Parameter",
    "Site",
    "Unknown",
    "hats",
    "known",
    "not_simulated",
    "parts_of",
    "parts_of_finding",
    "register",
    "unknown_part",
]
