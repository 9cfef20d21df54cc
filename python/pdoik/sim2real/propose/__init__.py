"""The motion that settles what a diagnosis leaves open.

Comes in: a diagnosis with the study it is of. Goes out: a motion from rest to rest within limits,
clear of obstacles, along which what is listed as equivalent predicts torques as different as can
be, and the confidence to expect after it. It is run, logged, added to the study and diagnosed.
"""

from .expected import Prospect
from .figures import Figure
from .limits import Limits, limits_of
from .proposal import Proposal
from .propose import NothingToSettleError, propose
from .wishes import Wishes

__all__ = [
    "Figure",
    "Limits",
    "NothingToSettleError",
    "Proposal",
    "Prospect",
    "Wishes",
    "limits_of",
    "propose",
]
