"""A torque reading that is wrong by a factor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from .effect import Columns, Effect, Parameter, Place, Shape

OF_BOTH, OF_REPORT, OF_DRIVE = 0.0, 1.0, 2.0
"""Shapes: report and command are wrong alike; the report alone; what the drive makes of it."""


class TorqueGain(Effect):
    """tau_reported = k tau."""

    id = "torque_gain"
    on = "joint"
    equation = "tau_reported = k tau"
    parameters = (Parameter("gain", "-"),)
    confused_with = ("payload", "link_inertial_error", "load_dependent_friction")
    decided_by = "the same motion with a known weight in the hand and without"
    source = "Gautier and Briot, ICRA 2011 (global identification of drive gains)"
    complexity = 2
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
        """The rigid body's torque, the command, the law."""
        (j,) = place.joints
        columns: Columns = {}
        if shape[0] != OF_DRIVE:
            columns["torque", j] = motion.tau[:, j, None]
        if shape[0] != OF_BOTH:
            if motion.has_command(j) and motion.command is not None:
                columns["drive", j] = motion.command[:, j, None]
            elif motion.has_law(j) and motion.law is not None:
                columns["law", j] = motion.law[:, j, None]
        return columns

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Coefficient k - 1: between half and double."""
        return np.full(1, -0.7), np.full(1, 1.5)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The gain."""
        return {"gain": 1.0 + float(beta[0])}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """By one less."""
        return shape or (OF_BOTH,), np.array([values["gain"] - 1.0])

    def variant(self, shape: Shape) -> str:
        """Whether the report is wrong or the drive; "" where both are, or nobody can tell."""
        return {OF_BOTH: "", OF_REPORT: "report", OF_DRIVE: "drive"}[shape[0]]

    def trifling(self, values: Mapping[str, float]) -> bool:
        """Less than half a percent."""
        return abs(values["gain"] - 1.0) < 5e-3

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"The torque of {where} reads {values['gain']:.3g} times what it is."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"in proportion to the torque of {where}"
