"""Names of a recording's columns, and the raw columns of a file."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable
from dataclasses import dataclass

from pdoik.errors import LoadError

from .recording import CHANNELS, FloatArray

SUPPLY = "volts"
"""Column of the supply that all joints share; `voltage.<joint>` is that of one."""

TIP = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""What follows `tip.` in the columns of the measured tip pose."""

# What other logs call the channels.
_FOREIGN = {
    "position": "q",
    "pos": "q",
    "angle": "q",
    "velocity": "dq",
    "vel": "dq",
    "qd": "dq",
    "qdot": "dq",
    "dotq": "dq",
    "effort": "tau",
    "torque": "tau",
    "torq": "tau",
    "trq": "tau",
    "i": "current",
    "curr": "current",
    "pwm": "duty",
    "duty_cycle": "duty",
    "volt": "voltage",
    "q_cmd": "q_des",
    "q_ref": "q_des",
    "q_desired": "q_des",
    "qdes": "q_des",
    "dq_cmd": "dq_des",
    "dq_ref": "dq_des",
    "tau_des": "tau_cmd",
    "tau_ref": "tau_cmd",
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """Columns as a file has them, in its own units and times."""

    name: str
    start: float  # time of the first row [s]
    time: FloatArray  # (T,) since the first row [s]
    columns: dict[str, FloatArray]  # (T,) each; NaN where nothing was logged
    others: tuple[str, ...] = ()  # columns of the file that were not read
    notes: tuple[str, ...] = ()


def channel_of(column: str) -> tuple[str, str] | None:
    """Channel and joint of a column `channel.joint`, None if it is none."""
    channel, dot, joint = column.partition(".")
    return (channel, joint) if dot and joint and channel in CHANNELS else None


def is_known(column: str) -> bool:
    """Whether a column's name is one that recordings have."""
    named = column in ("time", SUPPLY) or column in tip_columns()
    return named or channel_of(column) is not None


def tip_columns() -> tuple[str, ...]:
    """Names of the columns of the tip's pose."""
    return tuple(f"tip.{part}" for part in TIP)


def joints_of(columns: Iterable[str]) -> tuple[str, ...]:
    """Joints that have a position column, in the file's order."""
    found = (channel_of(column) for column in columns)
    return tuple(pair[1] for pair in found if pair is not None and pair[0] == "q")


def nearest(name: str, known: Collection[str], count: int = 3) -> str:
    """The names most like `name`, as the end of a message: "; nearest: 'a', 'b'" or ""."""
    low = {each.lower(): each for each in known}
    found = difflib.get_close_matches(name.lower(), low, n=count, cutoff=0.5)
    return f"; nearest: {', '.join(repr(low[each]) for each in found)}" if found else ""


def check_names(table: Table, joints: Collection[str], ignore: Collection[str]) -> None:
    """Ask about columns that look like a channel of the study's joints under another name.

    Raises:
        LoadError: a column is probably misnamed.
    """
    for column in table.others:
        if column in ignore:
            continue
        meant = _meant(column, joints)
        if meant is not None and meant not in table.columns:
            raise LoadError(
                f"{table.name}: column {column!r} is none that pdoik knows; if {meant!r} is meant,"
                f" rename it, else list it in the study: 'ignore: [{column}]'"
            )


def _meant(column: str, joints: Collection[str]) -> str | None:
    head, dot, joint = column.partition(".")
    if not dot or joint not in joints:
        return _unseparated(column, joints)
    channel = head.strip().lower()
    if channel in CHANNELS:
        return f"{channel}.{joint}"
    if channel in _FOREIGN:
        return f"{_FOREIGN[channel]}.{joint}"
    if len(channel) >= 3:
        close = difflib.get_close_matches(channel, CHANNELS, n=1, cutoff=0.8)
        if close:
            return f"{close[0]}.{joint}"
        if any(sorted(channel) == sorted(each) for each in CHANNELS if len(each) == len(channel)):
            swapped = next(each for each in CHANNELS if sorted(each) == sorted(channel))
            return f"{swapped}.{joint}"
    return None


def _unseparated(column: str, joints: Collection[str]) -> str | None:
    """`tau_joint1`, `tau/joint1`, `tau joint1` for `tau.joint1`."""
    for joint in joints:
        for separator in ("_", "/", " ", "-", ":"):
            if column.lower().endswith(f"{separator}{joint}".lower()):
                return _meant(f"{column[: -len(joint) - 1]}.{joint}", joints)
    return None
