"""Logs of robots, of whatever kind, as arrays with names, units and a clock.

Comes in: a CSV, a ROS bag, MCAP, Parquet, NPZ, HDF5, a LeRobot folder, MATLAB's or JSON lines. Goes
out: its columns as channels of joints (a `Table`), and on even times, in SI units, what was faulty
repaired and said (a `Recording`).
"""

from typing import TYPE_CHECKING, Any

from .columns import Table
from .glitches import glitches
from .key import Key, Keys
from .recording import CHANNELS, OF_BASE, STILL, FloatArray, Recording, Role
from .suspected_unit import SuspectedUnitError
from .units import Units, units_from

__all__ = [
    "CHANNELS",
    "GAP",
    "KINDS",
    "OF_BASE",
    "STILL",
    "Column",
    "FloatArray",
    "Key",
    "Keys",
    "Known",
    "Log",
    "Part",
    "Reading",
    "Recording",
    "Role",
    "SuspectedUnitError",
    "Table",
    "Units",
    "glitches",
    "on_grid",
    "read_log",
    "register",
    "to_recording",
    "uniform_grid",
    "units_from",
]

if TYPE_CHECKING:
    from .check_recording import to_recording
    from .logs import KINDS, Column, Log, Part, register
    from .names.known import Known
    from .read import read_log
    from .reading import Reading
    from .resample import GAP, on_grid, uniform_grid
else:
    _LATER = {  # with readers of files, or SciPy: imported when asked for
        "GAP": "resample",
        "KINDS": "logs",
        "Column": "logs",
        "Known": "names.known",
        "Log": "logs",
        "Part": "logs",
        "Reading": "reading",
        "on_grid": "resample",
        "read_log": "read",
        "register": "logs",
        "to_recording": "check_recording",
        "uniform_grid": "resample",
    }

    def __getattr__(name: str) -> Any:
        if name not in _LATER:
            raise AttributeError(f"module 'pdoik.recordings' has no attribute {name!r}")
        from importlib import import_module

        from pdoik._extras import asks_for

        with asks_for("sim2real"):
            value = getattr(import_module(f"{__name__}.{_LATER[name]}"), name)
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *_LATER})
