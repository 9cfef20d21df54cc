"""A torque reading that is not zero at zero."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..motion.motion import Motion
from ..motion.place import Shape
from ..study.recording import FloatArray
from .effect import Parameter
from .torque_channel import OF_BOTH, TorqueChannel


class TorqueOffset(TorqueChannel):
    """tau_reported = tau + b."""

    id = "torque_offset"
    on = "joint"
    equation = "tau_reported = tau + b"
    parameters = (Parameter("offset", "N m"),)
    confused_with = ("link_inertial_error", "gravity_direction", "asymmetric_friction")
    decided_by = "a rest in a pose where gravity does not load the joint"
    source = "drive calibration"
    per_joint_moving = False

    def error(self, motion: Motion, true: FloatArray) -> FloatArray:
        """A constant."""
        return np.ones((len(true), 1))

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The offset."""
        return {"offset": float(beta[0])}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The offset."""
        return shape or (OF_BOTH,), np.array([values["offset"]])

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"The torque of {where} is off by {values['offset']:.3g} N m, always the same."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"always, {where} moving or not"
