"""The motion that settles what a diagnosis leaves open.

Comes in: a diagnosis with the study it is of. Goes out: a motion from rest to rest within limits,
clear of obstacles, along which what is listed as equivalent predicts torques as different as can
be, and the confidence to expect after it. It is run, logged, added to the study and diagnosed.
"""

from .clear import Clear
from .excitation import Frame, motion_of, random_recipe
from .expected import Prospect
from .figures import Figure
from .limits import Limits, limits_of
from .path import STEP, Path, path_of
from .proposal import Proposal
from .propose import NothingToSettleError, propose
from .questions import open_findings, said
from .wishes import Wishes

__all__ = [
    "STEP",
    "Clear",
    "Figure",
    "Frame",
    "Limits",
    "NothingToSettleError",
    "Path",
    "Proposal",
    "Prospect",
    "Wishes",
    "limits_of",
    "motion_of",
    "open_findings",
    "path_of",
    "propose",
    "random_recipe",
    "said",
]
