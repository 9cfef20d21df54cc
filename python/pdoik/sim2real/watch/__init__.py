"""A diagnosed machine, watched: what has changed since, at which joint, when, and why.

Comes in: `Model` with the floor of its residuals, and rows of logs as they are written. Goes out:
`Alarm`s.
"""

from .alarm import Alarm, Cause, Figure
from .calibrate import calibrated
from .charts import Charts
from .csv_stream import CsvStream
from .cusum import Cusum, average_run_length, threshold_for
from .of_study import with_floor
from .residuals import ResidualRows, Residuals, joined
from .tail import Folder, Piece, Tail
from .today import OrdinaryToday
from .watch import Watch
from .windows import Rows, Windows

__all__ = [
    "Alarm",
    "Cause",
    "Charts",
    "CsvStream",
    "Cusum",
    "Figure",
    "Folder",
    "OrdinaryToday",
    "Piece",
    "ResidualRows",
    "Residuals",
    "Rows",
    "Tail",
    "Watch",
    "Windows",
    "average_run_length",
    "calibrated",
    "joined",
    "threshold_for",
    "with_floor",
]
