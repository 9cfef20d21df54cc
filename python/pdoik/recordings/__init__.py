"""Logs of robots, of whatever kind, as arrays with names, units and a clock.

    from pdoik import recordings

    log = recordings.read_log("run.mcap")
    log.names, log.time, log.q  # (n) joints, (T,) [s], (T, n) [rad]
    print(log)  # what was read, in which units, by which clock, and what is doubtful
    recording = log.recording()  # on even times, glitches left out, encoders unwrapped

Comes in: a CSV, a ROS bag, MCAP, Parquet, NPZ, HDF5, a LeRobot folder, MATLAB's or JSON lines. Goes
out: a `RobotLog` of its own rows, and of that a `Recording`. Needs pip install 'pdoik[sim2real]'.
"""

from typing import TYPE_CHECKING

from pdoik._later import later

from .columns import Table, joints_of
from .glitches import glitches
from .key import Key, Keys
from .recording import CHANNELS, OF_BASE, STILL, FloatArray, Recording, Role
from .suspected_unit import SuspectedUnitError
from .units import Units, units_from

__all__ = [
    "CHANNELS",
    "GAP",
    "KINDS",
    "MAX_ROWS",
    "OF_BASE",
    "STILL",
    "Clock",
    "Column",
    "ColumnsKey",
    "FloatArray",
    "Key",
    "Keys",
    "Log",
    "Part",
    "Reading",
    "Recording",
    "RobotLog",
    "Role",
    "SuspectedUnitError",
    "Table",
    "Unit",
    "Units",
    "check_names",
    "columns_key",
    "entry_keys",
    "glitches",
    "joints_of",
    "moves",
    "on_grid",
    "read_log",
    "register",
    "to_recording",
    "uniform_grid",
    "units_from",
    "with_jumps_mended",
]

if TYPE_CHECKING:
    from .check_recording import moves, to_recording
    from .logs import KINDS, MAX_ROWS, Column, Log, Part, entry_keys, register
    from .mend_jumps import with_jumps_mended
    from .names import ColumnsKey, check_names, columns_key
    from .reading import Reading
    from .resample import GAP, on_grid, uniform_grid
    from .robot_log import Clock, RobotLog, Unit, read_log
else:  # with readers of files, or SciPy: imported when asked for
    __getattr__, __dir__ = later(
        __name__,
        {
            "check_recording": "moves to_recording",
            "logs": "KINDS MAX_ROWS Column Log Part entry_keys register",
            "mend_jumps": "with_jumps_mended",
            "names": "ColumnsKey check_names columns_key",
            "reading": "Reading",
            "resample": "GAP on_grid uniform_grid",
            "robot_log": "Clock RobotLog Unit read_log",
        },
        "sim2real",
    )
