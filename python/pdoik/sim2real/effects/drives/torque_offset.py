"""A torque reading that is not zero at zero."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Motion, Place, Shape
from ...simulation import DriveChange, Part, SensorChange
from ..effect import Example, Parameter
from ..site import Site
from .torque_channel import OF_BOTH, TorqueChannel


class TorqueOffset(TorqueChannel):
    """tau_reported = tau + b."""

    id = "torque_offset"
    family = "torque"
    on = "joint"
    equation = "tau_reported = tau + b"
    parameters = (Parameter("offset", "N m"),)
    confused_with = ("link_inertial_error", "gravity_direction", "asymmetric_friction")
    decided_by = "a rest in a pose where gravity does not load the joint"
    source = "drive calibration"
    trifle = 0.03  # of the usual torque: zeros of current sensors
    example = Example(values={"offset": 0.8})
    against = "q"
    gated = True
    ordinary = True
    one_of = "one way"
    size_first = True

    def error(self, motion: Motion, true: FloatArray) -> FloatArray:
        """A constant."""
        return np.ones((len(true), 1))

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The offset."""
        return shape or (OF_BOTH,), np.array([values["offset"]])

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Less than a few hundredths of what the joint usually bears."""
        (j,) = place.joints
        usual = float(np.sqrt(np.mean(motion.borne[:, j] ** 2)))
        return abs(values["offset"]) < self.trifle * usual

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        offset = site["offset"]
        if site.variant == "report":
            return site.each(lambda j: SensorChange(joint=j, channel="tau", offset=-offset))
        if site.variant == "drive":
            return site.each(lambda j: DriveChange(joint=j, command_offset=offset))
        return site.each(lambda j: DriveChange(joint=j, offset=offset))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"The torque of {where} has a constant offset of {values['offset']:.3g} N m."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"always, {where} moving or not"
