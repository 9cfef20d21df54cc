"""Names of a recording's columns, and the raw columns of a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from .recording import CHANNELS, FloatArray

SUPPLY = "volts"
"""Column of the supply that all joints share; `voltage.<joint>` is that of one."""

POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""What follows `tip.` and `base.` in the columns of a measured pose."""

VECTORS = {"gyro": ("x", "y", "z"), "acc": ("x", "y", "z")}
"""What follows the names of an IMU's channels."""

CONTACT = "contact."
"""What stands before a foot's link in the column of its sensor."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """Columns as a file has them, in its own units and times."""

    name: str
    start: float  # time of the first row [s]
    time: FloatArray  # (T,) since the first row [s]
    clock: str = ""  # what the times were read from, in words
    columns: dict[str, FloatArray]  # (T,) each; NaN where nothing was logged
    others: tuple[str, ...] = ()  # columns of the file that were not read
    units: Mapping[str, str] = field(default_factory=dict)  # of columns, as the log says them
    readings: tuple[str, ...] = ()  # how names were understood; in the notes, too
    unsettled: tuple[str, ...] = ()  # why columns that look like channels were not read
    notes: tuple[str, ...] = ()


def channel_of(column: str) -> tuple[str, str] | None:
    """Channel and joint of a column `channel.joint`, None if it is none."""
    channel, dot, joint = column.partition(".")
    return (channel, joint) if dot and joint and channel in CHANNELS else None


def is_known(column: str) -> bool:
    """Whether a column's name is one that recordings have."""
    named = column in ("time", SUPPLY) or column.startswith(CONTACT)
    parts = {"tip": POSE, "base": POSE, **VECTORS}
    channel, _, part = column.partition(".")
    return named or part in parts.get(channel, ()) or channel_of(column) is not None


def pose_columns(of: str) -> tuple[str, ...]:
    """Names of the columns of a pose, of `tip` or `base`."""
    return tuple(f"{of}.{part}" for part in POSE)


def joints_of(columns: Iterable[str]) -> tuple[str, ...]:
    """Joints that have a position column, in the file's order."""
    found = (channel_of(column) for column in columns)
    return tuple(pair[1] for pair in found if pair is not None and pair[0] == "q")
