"""Which pairs of links need no test against each other, found by sampling configurations.

In goes a robot with its hulls and the description whose meshes they hold; out come the pairs, as
MoveIt's Setup Assistant sorts them, an SRDF with them, and what share of free configurations the
hulls still refuse.
"""

from .meshes import Mesh, meet
from .report import ClearanceCount, PairCount, PairReport
from .sample import sample_pairs

__all__ = [
    "ClearanceCount",
    "Mesh",
    "PairCount",
    "PairReport",
    "meet",
    "sample_pairs",
]
