"""A diagnosed machine, watched: what has changed since, at which joint, when, and why.

Comes in: `Model` with the floor of its residuals, and rows of logs as they are written. Goes out:
`Alarm`s.
"""

from .alarm import Alarm, Cause, Figure
from .calibrate import calibrated
from .watch import Watch

__all__ = ["Alarm", "Cause", "Figure", "Watch", "calibrated"]
