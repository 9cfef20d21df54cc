"""A channel that is logged late."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Key, Motion, Place, Shape, shifted
from ...simulation import Part, SensorChange
from ..effect import Effect, Example, Parameter
from ..site import Site
from .sensor_gain import channel_of, through_law

OF_TORQUE, OF_SPEED = 0.0, 1.0


_OF_LOG = 0.4  # periods of the log within which jitter and ticks may look like a skew


class TimestampSkew(Effect):
    """channel_logged(t) = channel(t - s), of torque or of speed."""

    id = "timestamp_skew"
    name = "skewed time stamps"
    family = "timing"
    on = "channel"
    equation = "logged(t) = true(t - s)"
    parameters = (Parameter("skew", "s", lower=-0.3, upper=0.3),)
    confused_with = ("command_delay", "actuator_lag", "viscous_friction")
    decided_by = "a knock on the arm at rest: which channel sees it first"
    source = "clocks of separate buses"
    example = Example(values={"skew": 0.012}, shape=(OF_TORQUE, 0.012), nothing={"skew": 0.0})
    fixed = True
    complexity = 2
    blurred_by_sampling = True
    shared = True
    makes_up_for_misfit = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Both signs [s]."""
        times = (0.003, 0.006, 0.012, 0.025, 0.05, 0.1)
        shapes: list[Shape] = []
        (j,) = place.joints
        if motions[0].source in ("tau", "current"):
            shapes += [(OF_TORQUE, sign * time) for time in times for sign in (1, -1)]
        if motions[0].measured_dq is not None and np.isfinite(motions[0].measured_dq[:, j]).all():
            shapes += [(OF_SPEED, sign * time) for time in times for sign in (1, -1)]
        return shapes

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The channel late less the channel."""
        (j,) = place.joints
        what, skew = shape
        if what == OF_SPEED:
            speed = motion.dq[:, j]
            late = shifted(speed, skew, motion.period) - speed
            return {("velocity", j): late[:, None], **through_law(motion, j, late)}
        tau = motion.borne[:, j]
        columns: dict[Key, FloatArray] = {
            ("torque", j): (shifted(tau, skew, motion.period) - tau)[:, None]
        }
        if motion.has_command(j):
            assert motion.command is not None
            command = motion.command[:, j]
            columns["drive", j] = (shifted(command, skew, motion.period) - command)[:, None]
        elif motion.has_law(j):
            assert motion.law is not None
            law = motion.law[:, j]
            columns["law", j] = (shifted(law, skew, motion.period) - law)[:, None]
        return columns

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The skew."""
        return {"skew": shape[1]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """The channel is what it is; the time within a factor."""
        what, time = shape
        low, high = sorted((0.4 * time, 2.5 * time))
        skew = self.parameters[0]
        return [(what, what), (max(low, skew.lower), min(high, skew.upper))]

    def negligible(self, motions: Sequence[Motion], shape: Shape) -> bool:
        """Whether it is less than the sampling can show."""
        first = motions[0]
        period = first.controller.period if first.controller is not None else None
        blur = max(period or 0.0, _OF_LOG * first.recording.raw_period)
        return abs(shape[1]) < (blur if period else first.recording.raw_period)

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        return (shape[0] if shape else OF_TORQUE, values["skew"]), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """The channel."""
        return "speed" if shape[0] == OF_SPEED else "torque"

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        channel = channel_of(site.variant, "tau")
        return site.each(lambda j: SensorChange(joint=j, channel=channel, skew=site["skew"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        late = "late" if values["skew"] > 0 else "early"
        return f"A channel of {where} is logged {1e3 * abs(values['skew']):.3g} ms too {late}."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"fast changes of {where}"
