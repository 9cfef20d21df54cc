"""What is measured of the true joints."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from pdoik.recordings import FloatArray

from .description import nearest
from .parts import Coupling, Part, SensedChannel, SensorChange

CHANNELS: tuple[SensedChannel, ...] = ("q", "dq", "tau")


class Sensors:
    """Gain, offset and skew of each channel, and motors that move two joints."""

    def __init__(self, joints: tuple[str, ...], parts: Iterable[Part] = ()) -> None:
        n = len(joints)
        self.gain = {channel: np.ones(n) for channel in CHANNELS}
        self.offset = {channel: np.zeros(n) for channel in CHANNELS}
        self.skew = {channel: np.zeros(n) for channel in CHANNELS}
        self.log_gain = {channel: np.ones(n) for channel in CHANNELS}  # of the log alone
        self.motors = np.eye(n)  # motor coordinates = motors @ true coordinates
        self.couplings: list[tuple[int, int, float]] = []
        for part in parts:
            if isinstance(part, SensorChange):
                k = joints.index(nearest(part.joint, joints, "joint"))
                gain = self.log_gain if part.log_only else self.gain
                gain[part.channel][k] *= part.gain
                self.offset[part.channel][k] += part.offset
                self.skew[part.channel][k] += part.skew
            elif isinstance(part, Coupling):
                k = joints.index(nearest(part.joint, joints, "joint"))
                j = joints.index(nearest(part.by, joints, "joint"))
                self.motors[k, j] -= part.ratio
                self.couplings.append((k, j, part.ratio))
        self._true = np.linalg.inv(self.motors)
        self.plain = not self.couplings and all(
            (self.gain[channel] == 1).all() and not self.offset[channel].any()
            for channel in ("q", "dq")
        )

    def seen(self, channel: SensedChannel, true: FloatArray) -> FloatArray:
        """What the controller reads of true values (..., n)."""
        motor = true if channel == "tau" else true @ self.motors.T
        return np.asarray(self.gain[channel] * (motor - self.offset[channel]))

    def measured(self, channel: SensedChannel, true: FloatArray) -> FloatArray:
        """What is logged of true values (..., n), without skew."""
        return np.asarray(self.log_gain[channel] * self.seen(channel, true))

    def true(self, channel: SensedChannel, measured: FloatArray) -> FloatArray:
        """The true values (..., n) of what was logged."""
        motor = measured / (self.gain[channel] * self.log_gain[channel]) + self.offset[channel]
        return np.asarray(motor if channel == "tau" else motor @ self._true.T)
