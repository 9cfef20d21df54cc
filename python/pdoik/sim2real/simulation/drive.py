"""What drives make of commanded torques, joint by joint."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import replace

from .parts import DriveChange


def combine(changes: Iterable[DriveChange], joint: str) -> DriveChange:
    """All changes of one joint's drive as one: the order among them does not matter much."""
    whole = DriveChange(joint=joint)
    for change in changes:
        if change.joint == joint:
            whole = replace(
                whole,
                delay=whole.delay + change.delay,
                command_lag=whole.command_lag + change.command_lag,
                torque_delay=whole.torque_delay + change.torque_delay,
                limit=min(whole.limit, change.limit),
                stall_torque=min(whole.stall_torque, change.stall_torque),
                no_load_speed=min(whole.no_load_speed, change.no_load_speed),
                time_constant=whole.time_constant + change.time_constant,
                gain=whole.gain * change.gain,
                offset=whole.offset + change.offset,
                command_gain=whole.command_gain * change.command_gain,
                command_offset=whole.command_offset + change.command_offset,
            )
    return whole


class Drive:
    """Limit, first-order lag, and what the drive believes against what it exerts."""

    __slots__ = (
        *("_change", "_command_gain", "_command_offset", "_decay", "_gain", "_limit", "_mean"),
        *("_offset", "_slope", "_stall", "_state"),
    )

    def __init__(self, change: DriveChange, dt: float) -> None:
        self._change, self._limit = change, change.limit
        self._stall = change.stall_torque if math.isfinite(change.no_load_speed) else math.inf
        self._slope = self._stall / change.no_load_speed if math.isfinite(self._stall) else 0.0
        self._gain, self._offset = 1.0 / change.gain, change.offset
        self._command_gain, self._command_offset = change.command_gain, change.command_offset
        share = dt / max(change.time_constant, 1e-12)
        self._decay = math.exp(-share)  # of the distance to the command over a step
        self._mean = -math.expm1(-share) / share  # of that distance on average within the step
        self._state: float | None = None  # None until the first command, which finds it settled

    def __call__(self, command: float, speed: float = 0.0) -> tuple[float, float]:
        """Reported at the step's start, and exerted on average over the step [N m].

        Args:
            command: [N m].
            speed: of the joint [rad/s].
        """
        limit = self._limit
        command = command * self._command_gain + self._command_offset
        command = -limit if command < -limit else limit if command > limit else command
        if self._slope:
            most = max(self._stall - self._slope * speed, 0.0)
            least = min(-self._stall - self._slope * speed, 0.0)
            command = least if command < least else most if command > most else command
        state = self._state
        if state is None or not self._change.time_constant:
            self._state = state = command
        away = state - command
        self._state = command + away * self._decay
        return state, (command + away * self._mean - self._offset) * self._gain


class DelayLine:
    """The values of a while ago, straight lines between steps; the first value before it."""

    __slots__ = ("_past", "_share", "_steps")

    def __init__(self, delay: float, dt: float) -> None:
        whole = math.floor(delay / dt + 1e-9)
        self._share = max(delay / dt - whole, 0.0)
        self._steps = whole + 2
        self._past: deque[float] = deque(maxlen=self._steps)

    def __call__(self, value: float) -> float:
        past = self._past
        if not past:
            past.extend([value] * self._steps)
        past.append(value)
        return past[0] * self._share + past[1] * (1.0 - self._share)
