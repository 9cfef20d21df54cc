"""What drives and speed sensors are off by within their calibration: fitted, never named."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..effects.effect import Effect
from ..motion.motion import Motion
from ..motion.place import Balance, Columns, Place, Shape
from ..study.recording import FloatArray

ZERO, SCALE, SPEED = 0.0, 1.0, 2.0
"""Shapes: a drive's zero, its scale, a speed's scale."""


class Tolerance(Effect):
    """Of a joint's drive beside its command or law, and of its speed beside its position."""

    id = "tolerance"
    on = "drive"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Per newton metre, per one, per one."""
        (j,) = place.joints
        if shape[0] == SPEED:
            return {} if motion.measured_dq is None else {("velocity", j): motion.dq[:, j, None]}
        asked: tuple[Balance, FloatArray]
        if motion.has_command(j) and motion.command is not None:
            asked = "drive", motion.command[:, j]
        elif motion.has_law(j):
            asked = "law", motion.law_of(j)
        else:
            return {}
        balance, torque = asked
        column = np.ones_like(torque) if shape[0] == ZERO else torque
        return {(balance, j): column[:, None]}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"{where} is as exact as its calibration."
