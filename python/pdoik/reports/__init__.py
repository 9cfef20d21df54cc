"""A question to a solver and its answer in one file, for who is to find out what went wrong.

`write_report` writes it, `replay_report` asks again and judges: whether the answer is the same to
the bit, and whether what it claims holds by code of its own (`judge`), which takes no word of the
compiled library. The files are JSON, every number to the bit (`values`).
"""

from .call import Call
from .contacts import Wanted
from .convex import Body, apart, piece, to_shape
from .distances import segment_to_shape, to_spheroid
from .goals import goals_entry, read_goals
from .kinematics import Kinematics
from .mass import MassBox
from .replay import Replay, replay_report
from .requirements import Requirement, requirements
from .values import Entry, json_lines
from .write import ending_of, this_build, write_report

__all__ = [
    "Body",
    "Call",
    "Entry",
    "Kinematics",
    "MassBox",
    "Replay",
    "Requirement",
    "Wanted",
    "apart",
    "ending_of",
    "goals_entry",
    "json_lines",
    "piece",
    "read_goals",
    "replay_report",
    "requirements",
    "segment_to_shape",
    "this_build",
    "to_shape",
    "to_spheroid",
    "write_report",
]
