"""The joints' controllers: their laws from commands, motion and effort; duties turned into torques.

Comes in: `Prepared`, whose controllers the study may know, know in part, or not at all. Goes out:
`ControllerCheck`, a `ControllerEstimate` for each joint, and the study with gains that were not
known, with torques in place of duties, and with the times at which drives have let go. Next:
channels.
"""

from .check_controllers import ControllerCheck, check_controllers
from .cut_off import CutOff, cut_off, gained_by
from .estimate import joint_law
from .lateness import Late, later_ones
from .linear_law import Strip, law_of, strips_of
from .rows import Feeds, pieces_of
from .words import contradictions, of_load

__all__ = [
    "ControllerCheck",
    "CutOff",
    "Feeds",
    "Late",
    "Strip",
    "check_controllers",
    "contradictions",
    "cut_off",
    "gained_by",
    "joint_law",
    "later_ones",
    "law_of",
    "of_load",
    "pieces_of",
    "strips_of",
]
