"""Units of a log's columns, as the log or whoever reads it names them: factors to SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi
from typing import Any, Literal

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from .columns import SUPPLY

_ANGLE = {"rad": 1.0, "deg": pi / 180, "turn": 2 * pi}
_SPEED = {"rad/s": 1.0, "deg/s": pi / 180, "turn/s": 2 * pi, "rpm": pi / 30}
_LENGTH = {"m": 1.0, "mm": 1e-3}
_TORQUE = {"N.m": 1.0, "mN.m": 1e-3, "N.cm": 1e-2, "kN.m": 1e3, "N": 1.0}

KNOWN: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "q": {**_ANGLE, **_LENGTH},
    "dq": {**_SPEED, "m/s": 1.0, "mm/s": 1e-3},
    "tau": _TORQUE,
    "current": {"A": 1.0, "mA": 1e-3},
    "duty": {"1": 1.0, "%": 1e-2, "permille": 1e-3},
    "voltage": {"V": 1.0, "mV": 1e-3},
    "tip": _LENGTH,
    "base": _LENGTH,
    "gyro": {"rad/s": 1.0, "deg/s": pi / 180},
    "acc": {"m/s^2": 1.0, "g": 9.80665},
}
"""Units of each channel and their factor to SI."""

_PARENT = {"q_des": "q", "dq_des": "dq", "tau_cmd": "tau", SUPPLY: "voltage"}

Source = Literal["named", "log", "assumed"]
"""Who says a unit: who reads the log, the log itself, or nobody, then it is SI."""


@dataclass(frozen=True, slots=True)
class Units:
    """What is said of columns' units; commands have the unit of what they command."""

    named: Mapping[str, str] = field(default_factory=dict)  # of a channel or a column
    written: Mapping[str, str] = field(default_factory=dict)  # of columns, by a log itself

    def settles(self, channel: str) -> bool:
        """Whether somebody names the channel's unit: the log, or who reads it."""
        return any(each.partition(".")[0] == channel for each in (*self.named, *self.written))

    def factor(self, column: str, prismatic: bool = False) -> float:
        """The factor of a column to SI; angles' units do not touch slides."""
        unit, source = self.said_of(column)
        angular = unit in _ANGLE or unit in _SPEED
        if not unit or (prismatic and angular and source == "named"):
            return 1.0
        return _known(column)[unit]

    def said_of(self, column: str) -> tuple[str, Source]:
        """The unit that a column is said to be in, "" of none, and who says it."""
        channel, dot, joint = column.partition(".")
        above = parent(channel)
        for key in (column, channel, f"{above}{dot}{joint}", above):
            if key in self.named:
                return self.named[key], "named"
        written = self.written.get(column, self.written.get(channel))
        return ("", "assumed") if written is None else (written, "log")

    def with_written(self, written: Mapping[str, str]) -> Units:
        """The units with what a log says itself, where nobody else does."""
        return replace(self, written=written)


def units_from(content: Any, source: str) -> Units:
    """The units of a mapping such as {q: deg, tau: mN.m, q.gripper: mm}.

    Raises:
        LoadError: a channel or unit is not known.
    """
    if content is None:
        return Units()
    if not isinstance(content, dict):
        raise LoadError(f"{source}: units: expected '{{q: deg}}' or the like, got {content!r}")
    named = {}
    for key, unit in content.items():
        channel = str(key).partition(".")[0]
        if channel not in {*KNOWN, *_PARENT}:
            raise LoadError(f"{source}: units: no channel {key!r}{nearest(str(key), KNOWN)}")
        spelled = {_plain(each): each for each in _known(channel)}
        if _plain(str(unit)) not in spelled:
            raise LoadError(
                f"{source}: units: {key}: no unit {unit!r}; expected one of"
                f" {', '.join(_known(channel))}"
            )
        name = "voltage" if key == SUPPLY else str(key)
        named[name] = spelled[_plain(str(unit))]
    return Units(named)


def parent(column: str) -> str:
    """The channel of `KNOWN` whose units a channel or column has."""
    channel = column.partition(".")[0]
    return _PARENT.get(channel, channel)


def _known(channel: str) -> dict[str, float]:
    return KNOWN[parent(channel)]


def _plain(unit: str) -> str:
    return "".join(each for each in unit if each not in " .*·")
