"""Where something acts, and in which of the balances it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pdoik.recordings import FloatArray

from ..study import Payload

Balance = Literal[
    "torque", "drive", "law", "velocity", "tip", "servo", "base", "imu", "foot", "tilt", "grip"
]
Key = tuple[Balance, int]  # and its channel: a joint, an axis, a foot, or one of a foot's two axes
Columns = dict[Key, FloatArray]  # (T, k) for every channel that changes
Shape = tuple[float, ...]  # the parameters that enter nonlinearly


def tilt_key(foot: int, axis: int) -> Key:
    """The balance of a foot's tilt along the world's x or y."""
    return "tilt", 2 * foot + axis


def foot_of(key: Key) -> int:
    """The foot that one of the feet's balances is of."""
    return key[1] // 2 if key[0] == "tilt" else key[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """A part of time, or of the first joint's positions, outside which is nothing.

    Time is every recording's own, or the clock of the whole study, which runs on from recording to
    recording. An end at which the recordings stop is open.
    """

    of: Literal["time", "position", "clock"]
    low: float = -np.inf  # [s]; [rad], [m] for prismatic joints
    high: float = np.inf
    edge: float = 0.0  # over which it comes and goes, half of it outside

    def weight(self, x: FloatArray) -> FloatArray:
        """1 inside and 0 outside, straight lines between."""
        inside = np.minimum(x - self.low, self.high - x)
        return np.clip(0.5 + inside / max(self.edge, 1e-9), 0.0, 1.0)

    def weight_at(self, x: float) -> float:
        """The same of one value, quickly."""
        inside = 0.5 + min(x - self.low, self.high - x) / max(self.edge, 1e-9)
        return 0.0 if inside < 0.0 else 1.0 if inside > 1.0 else inside


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where an effect sits, by index: joints, a link (that of a joint), a window of a recording."""

    joints: tuple[int, ...] = ()
    link: int | None = None
    recording: str | None = None
    window: tuple[float, float] | None = None
    gate: Gate | None = None
    held: Payload | None = None  # the attached body without which it does nothing
    foot: int | None = None
