"""A recording of a robot's joints, on a uniform grid of time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Role = Literal["fit", "validate"]

STILL = 2e-3  # range of a joint that does not move [rad or m]

CHANNELS = ("q", "dq", "tau", "current", "duty", "voltage", "q_des", "dq_des", "tau_cmd")
"""Channels with a column per joint, as `channel.joint`."""

OF_BASE = ("base", "gyro", "acc", "contact")
"""Channels of a base that moves, and of the feet it stands on."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recording:
    """What was logged of one run. Arrays are (T, n), in the order of the joints.

    A channel that was not logged is None; one not logged for a joint is a column of NaN.
    """

    name: str  # the file's name, unique in the study
    file: str = ""  # its name where the recording is a part of one
    role: Role = "fit"
    start: float  # of the first sample on the log's clock [s]
    time: FloatArray  # (T,) uniform, from 0 [s]
    q: FloatArray  # [rad], [m] for prismatic joints; at the motor's side of the gear
    dq: FloatArray | None = None  # [rad/s]
    tau: FloatArray | None = None  # as the drive reports it [N m]
    current: FloatArray | None = None  # [A]
    duty: FloatArray | None = None  # of the supply that the motor is given, -1 to 1
    voltage: FloatArray | None = None  # of the supply [V]
    q_des: FloatArray | None = None
    dq_des: FloatArray | None = None
    tau_cmd: FloatArray | None = None
    tip: FloatArray | None = None  # (T, 7): x y z qw qx qy qz in the base frame
    base: FloatArray | None = None  # (T, 7): pose of the base link in the world, likewise
    gyro: FloatArray | None = None  # (T, 3) in the IMU's axes [rad/s]
    acc: FloatArray | None = None  # (T, 3) specific force, g upwards at rest, likewise [m/s^2]
    contact: FloatArray | None = None  # (T, feet) as the feet's sensors say, NaN without one
    valid: NDArray[np.bool_]  # (T,) False within gaps bridged by interpolation
    released: NDArray[np.bool_] | None = None  # True where the drive has let go; found, not logged
    raw_period: float  # median step of the file's time [s]
    jitter: float  # standard deviation of the file's time steps [s]
    steps: FloatArray | None = None  # (n,) of the encoders, in the unit of q, where they are seen
    notes: tuple[str, ...] = ()  # what was repaired, in words

    @property
    def period(self) -> float:
        """Step of the grid [s]."""
        return float(self.time[1] - self.time[0])

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels that were logged."""
        names = (*CHANNELS, "tip", *OF_BASE)
        return tuple(name for name in names if getattr(self, name) is not None)
