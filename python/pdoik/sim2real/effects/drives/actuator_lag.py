"""A drive that follows its command with a first-order lag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape, lagged
from ...simulation import DriveChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site
from .command_delay import (
    OF_POSITION,
    OF_TORQUE,
    TIMES,
    drive_shapes,
    drive_variant,
    late_position,
    late_torque,
    too_short,
)


class ActuatorLag(Effect):
    """T dtau/dt + tau = tau_cmd."""

    id = "actuator_lag"
    family = "timing"
    on = "drive"
    equation = "T dtau/dt + tau = tau_cmd"
    parameters = (Parameter("time_constant", "s", lower=0.0, upper=0.5),)
    confused_with = ("command_delay", "timestamp_skew", "coulomb_friction")
    decided_by = "a step of the command, sampled at 500 Hz or more: dead time, or a curve at once"
    source = "first-order lag of a current loop"
    slowest = 0.08  # of torque loops, pneumatic ones: 2 Hz [s]; what is slower is no lag
    at_bound = 0.98  # share of it, from which a time is at its bound
    example = Example(
        values={"time_constant": 0.02},
        shape=(OF_TORQUE, 0.02),
        nothing={"time_constant": 0.0},
    )
    fixed = True
    size_first = True
    simulated_rivals = ("command_delay",)
    complexity = 2
    is_delay = True
    blurred_by_sampling = True
    shared = True
    makes_up_for_misfit = True
    of_commands = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Time constants [s]."""
        return [
            (what, time)
            for what, time in drive_shapes(motions, place, TIMES)
            if what != OF_TORQUE or time < self.slowest
        ]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The lagged command less the command."""
        (j,) = place.joints
        what, time = shape
        if what == OF_POSITION:
            assert motion.q_des is not None
            aim = motion.q_des[:, j]
            late = lagged(aim, time, motion.period) - aim
            return late_position(motion, j, late)
        return late_torque(motion, j, lambda x: lagged(x, time, motion.period))

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The time constant."""
        return {"time_constant": shape[1]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """What lags is what it is; the time within a factor."""
        what, time = shape
        most = self.slowest if what == OF_TORQUE else self.parameters[0].upper
        return [(what, what), (0.4 * time, min(2.5 * time, most))]

    def possible(self, shape: Shape) -> bool:
        """Whether a torque loop may be as slow as that."""
        return shape[0] != OF_TORQUE or shape[1] < self.at_bound * self.slowest

    def negligible(self, motions: Sequence[Motion], shape: Shape) -> bool:
        """Whether it is less than the sampling can show."""
        return too_short(motions, shape)

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        return (shape[0] if shape else OF_POSITION, values["time_constant"]), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """What lags."""
        return drive_variant(shape)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        time = site["time_constant"]
        if site.variant == "position":
            return site.each(lambda j: DriveChange(joint=j, command_lag=time))
        return site.each(lambda j: DriveChange(joint=j, time_constant=time))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The drive of {where} follows its command with a lag of"
            f" {1e3 * values['time_constant']:.3g} ms."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"fast changes of the command of {where}"
