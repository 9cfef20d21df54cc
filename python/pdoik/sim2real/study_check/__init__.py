"""What a study can show before anything is searched in it: `pdoik study check` in Python.

Comes in: a study. Goes out: `StudyCheck`: channels, motion, and of every effect at every place the
smallest size that would be seen, or why none would.
"""

from .check import RecordingCheck, StudyCheck, check_study
from .joints import JointCheck
from .visible import Visible

__all__ = ["JointCheck", "RecordingCheck", "StudyCheck", "Visible", "check_study"]
