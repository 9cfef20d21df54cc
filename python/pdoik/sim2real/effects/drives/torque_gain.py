"""A torque reading that is wrong by a factor."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Motion, Place, Shape
from ...simulation import DriveChange, Part, SensorChange
from ..effect import Example, Parameter
from ..site import Site
from .torque_channel import OF_BOTH, TorqueChannel


class TorqueGain(TorqueChannel):
    """tau_reported = k tau."""

    id = "torque_gain"
    family = "torque"
    on = "joint"
    odds = 0.03
    equation = "tau_reported = k tau"
    parameters = (Parameter("gain", "-"),)
    confused_with = ("payload", "link_inertial_error", "load_dependent_friction")
    decided_by = "the same motion with a known weight in the hand and without"
    source = "Gautier and Briot, ICRA 2011 (global identification of drive gains)"
    trifle = 5e-3  # a gain off by less is as good as right
    example = Example(values={"gain": 1.1}, nothing={"gain": 1.0})
    complexity = 2
    per_joint_moving = False
    against = "load"
    gated = True

    def error(self, motion: Motion, true: FloatArray) -> FloatArray:
        """Error in proportion to the torque, (T, 1) [N m]."""
        return true[:, None]

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
        """Shape, and the coefficient (1,), the gain less one."""
        return shape or (OF_BOTH,), np.array([values["gain"] - 1.0])

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Less than half a percent."""
        return abs(values["gain"] - 1.0) < self.trifle

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        gain = site["gain"]
        if site.variant == "report":
            return site.each(lambda j: SensorChange(joint=j, channel="tau", gain=gain))
        if site.variant == "drive":
            return site.each(lambda j: DriveChange(joint=j, command_gain=gain))
        return site.each(lambda j: DriveChange(joint=j, gain=gain))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"The torque reading of {where} is {values['gain']:.3g} times the true torque."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"in proportion to the torque of {where}"
