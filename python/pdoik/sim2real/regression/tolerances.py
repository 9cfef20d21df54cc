"""What drives and speed sensors are off by within their calibration: fitted, never named."""

from __future__ import annotations

from collections.abc import Mapping

from ..effects import Effect
from ..effects.drives import OF_DRIVE, TorqueGain, TorqueOffset
from ..motion import Columns, Motion, Place, Shape

ZERO, SCALE, SPEED = 0.0, 1.0, 2.0
"""Shapes: a drive's zero, its scale, a speed's scale."""

_OF_DRIVES = {ZERO: TorqueOffset(), SCALE: TorqueGain()}


class Tolerance(Effect):
    """Error of a joint's drive against its command or law, of its speed against its position."""

    id = "tolerance"
    on = "drive"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Per newton metre, per one, per one."""
        (j,) = place.joints
        if shape[0] == SPEED:
            return {} if motion.measured_dq is None else {("velocity", j): motion.dq[:, j, None]}
        return _OF_DRIVES[shape[0]].columns(motion, place, (OF_DRIVE,))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """The tolerance in words."""
        return f"{where} is as exact as its calibration."
