"""What torque's gain and offset share: the report may be wrong, the command, or the drive."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ..effect import Effect

OF_BOTH, OF_REPORT, OF_DRIVE = 0.0, 1.0, 2.0
"""Shapes: report and command are wrong alike; the report alone; what the drive makes of it."""

_OF_DRIVE = -0.7  # log odds, half as likely


class TorqueChannel(Effect):
    """An error of a torque that shows in the balances that this torque enters."""

    @abstractmethod
    def error(self, motion: Motion, true: FloatArray) -> FloatArray:
        """Error per coefficient of a torque that truly is `true` (T,); (T, 1)."""

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Where it is wrong."""
        (j,) = place.joints
        first = motions[0]
        apart = first.has_command(j) or first.has_law(j)
        return [(OF_BOTH,), (OF_REPORT,), (OF_DRIVE,)] if apart else [(OF_BOTH,)]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """It is where it is."""
        return [(shape[0], shape[0])]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The error in the balance of torque, of the drive, of the law."""
        (j,) = place.joints
        columns: Columns = {}
        if shape[0] != OF_DRIVE:
            columns["torque", j] = self.error(motion, motion.borne[:, j])
        if shape[0] != OF_BOTH:
            if motion.has_command(j) and motion.command is not None:
                columns["drive", j] = self.error(motion, motion.command[:, j])
            elif motion.has_law(j):
                columns["law", j] = self.error(motion, motion.law_of(j))
        return columns

    def log_prior(self, shape: Shape) -> float:
        """A sensor is wrong more often than what a drive makes of its command."""
        return _OF_DRIVE if shape[0] == OF_DRIVE else 0.0

    def variant(self, shape: Shape) -> str:
        """Whether the report is wrong or the drive; "" where both are, or nothing decides."""
        return {OF_BOTH: "", OF_REPORT: "report", OF_DRIVE: "drive"}[shape[0]]
