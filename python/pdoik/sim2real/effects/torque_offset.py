"""A torque reading that is not zero at zero."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from .effect import Columns, Effect, Parameter, Place, Shape

OF_BOTH, OF_REPORT, OF_DRIVE = 0.0, 1.0, 2.0
"""Shapes: report and command are wrong alike; the report alone; what the drive makes of it."""


class TorqueOffset(Effect):
    """tau_reported = tau + b."""

    id = "torque_offset"
    on = "joint"
    equation = "tau_reported = tau + b"
    parameters = (Parameter("offset", "N m"),)
    confused_with = ("link_inertial_error", "gravity_direction", "asymmetric_friction")
    decided_by = "a rest in a pose where gravity does not load the joint"
    source = "drive calibration"
    per_joint_moving = False

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
        """A constant."""
        (j,) = place.joints
        one = np.ones((len(motion.time), 1))
        columns: Columns = {}
        if shape[0] != OF_DRIVE:
            columns["torque", j] = one
        if shape[0] != OF_BOTH:
            if motion.has_command(j):
                columns["drive", j] = one
            elif motion.has_law(j):
                columns["law", j] = one
        return columns

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The offset."""
        return {"offset": float(beta[0])}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The offset."""
        return shape or (OF_BOTH,), np.array([values["offset"]])

    def variant(self, shape: Shape) -> str:
        """Whether the report is wrong or the drive; "" where both are, or nobody can tell."""
        return {OF_BOTH: "", OF_REPORT: "report", OF_DRIVE: "drive"}[shape[0]]

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"The torque of {where} is off by {values['offset']:.3g} N m, always the same."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"always, {where} moving or not"
