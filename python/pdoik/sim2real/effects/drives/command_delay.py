"""Commands that act some time after they were given."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape, lagged, shifted
from ...simulation import DriveChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site

OF_POSITION, OF_TORQUE = 0.0, 1.0
"""First entry of a shape: whether the commanded position or the torque comes late."""

LEAST_POSITION, LEAST_TORQUE = 0.2, 0.3
"""Shares of the controller's period below which a position's or torque's delay is not claimed."""

LEAST_OF_LOG = 0.05  # the same of the log's period
TIMES = (0.0008, 0.002, 0.004, 0.007, 0.012, 0.02, 0.035, 0.06, 0.1, 0.16, 0.3)
"""Delays and time constants to try first [s]."""


def late_position(motion: Motion, j: int, change: FloatArray) -> Columns:
    """Columns of a commanded position that differs by `change` (T,) from what was logged.

    In the law's balance where a torque was recorded, else in the torque's, where the law stands
    for the torque.
    """
    assert motion.controller is not None
    torque = motion.controller.kp[j] * change
    if motion.has_law(j):
        return {("law", j): torque[:, None]}
    return {("torque", j): -torque[:, None]}


def late_torque(motion: Motion, j: int, late: Callable[[FloatArray], FloatArray]) -> Columns:
    """Columns of a torque that follows its command as `late` says.

    A command that is held until the next comes half a period late on average: that is no delay.
    """
    if motion.has_command(j):
        assert motion.command is not None
        command = motion.command[:, j]
        return {("drive", j): (late(held(motion, command)) - command)[:, None]}
    if motion.source == "tau" or motion.source == "current":
        assert motion.law is not None
        law = motion.law[:, j]  # as held
        return {("law", j): (late(law) - law)[:, None]}
    assert motion.torque is not None
    command = motion.torque[:, j]
    acting = command if motion.source == "law" else held(motion, command)
    return {("torque", j): (command - late(acting))[:, None]}


def held(motion: Motion, command: FloatArray) -> FloatArray:
    """A command as it acts on average where the controller holds it over a known period; (T,)."""
    period, known = period_of(motion)
    return shifted(command, 0.5 * period, motion.period) if known else command


def period_of(motion: Motion) -> tuple[float, bool]:
    """The controller's period [s], and whether it is known: if not, the log's stands for it."""
    period = motion.controller.period if motion.controller is not None else None
    return (period, True) if period else (motion.recording.raw_period, False)


def drive_shapes(motions: Sequence[Motion], place: Place, times: Sequence[float]) -> list[Shape]:
    """Shapes (what, time) for the channels that were recorded."""
    (j,) = place.joints
    first = motions[0]
    if first.source == "":
        return []
    shapes: list[Shape] = []
    if first.law is not None:
        shapes += [(OF_POSITION, time) for time in times]
    if first.has_command(j) or first.law is not None or first.source == "tau_cmd":
        shapes += [(OF_TORQUE, time) for time in times]
    return shapes


def drive_variant(shape: Shape) -> str:
    """Whether the commanded position or torque comes late."""
    return "torque" if shape[0] == OF_TORQUE else "position"


def within_sampling(motions: Sequence[Motion], time: float) -> bool:
    """Whether a skew of clocks is within what sampling and the controller's ticks blur [s]."""
    first = motions[0]
    period = first.controller.period if first.controller is not None else None
    return abs(time) < max(2.5 * (period or 0.0), 1.0 * first.recording.raw_period)


def too_short(motions: Sequence[Motion], shape: Shape) -> bool:
    """Whether a delay or lag is within three times what machines without any seem to have.

    Where a law or a torque is known; of positions alone nothing below a sample can be detected.
    """
    first = motions[0]
    if first.source == "":
        return within_sampling(motions, shape[1])
    period, known = period_of(first)
    share = (LEAST_POSITION if shape[0] == OF_POSITION else LEAST_TORQUE) if known else 1.0
    return abs(shape[1]) < max(share * period, LEAST_OF_LOG * first.recording.raw_period)


class CommandDelay(Effect):
    """command(t - d) acts at t."""

    id = "command_delay"
    family = "timing"
    on = "drive"
    equation = "tau(t) = tau_cmd(t - d), or q_des(t - d) enters the controller"
    parameters = (
        Parameter("delay", "s", lower=0.0, upper=0.5),
        Parameter("time_constant", "s", lower=0.0, upper=0.5),  # of a servo, positions only
    )
    confused_with = ("actuator_lag", "timestamp_skew", "coulomb_friction")
    decided_by = "a step of the command, sampled at 500 Hz or more: dead time, or a curve at once"
    source = "transport delay"
    least_lag = 1e-3  # below which a servo follows at once [s]
    example = Example(values={"delay": 0.03}, shape=(OF_POSITION, 0.03), nothing={"delay": 0.0})
    fixed = True
    size_first = True
    simulated_rivals = ("actuator_lag",)
    complexity = 2
    is_delay = True
    blurred_by_sampling = True
    shared = True
    makes_up_for_misfit = True
    of_commands = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Delays from parts of a sample to a third of a second [s]."""
        if motions[0].source == "" and motions[0].q_des is not None:
            lags = (0.0, 0.03, 0.08, 0.2)
            return [(OF_POSITION, time, lag) for time in TIMES[4:] for lag in lags]
        return drive_shapes(motions, place, TIMES)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The command late less the command."""
        (j,) = place.joints
        what, delay = shape[:2]
        if motion.source == "":
            assert motion.q_des is not None
            aim = motion.q_des[:, j]
            late = shifted(aim, delay, motion.period)
            if shape[2] > self.least_lag:
                late = lagged(late, shape[2], motion.period)
            return {("servo", j): (late - aim)[:, None]}
        if what == OF_POSITION:
            assert motion.q_des is not None
            assert motion.controller is not None
            aim = motion.q_des[:, j]
            late = shifted(aim, delay, motion.period) - aim
            if motion.dq_des is not None:
                speed = motion.dq_des[:, j]
                ratio = motion.controller.kd[j] / motion.controller.kp[j]
                late = late + ratio * (shifted(speed, delay, motion.period) - speed)
            return late_position(motion, j, late)
        return late_torque(motion, j, lambda x: shifted(x, delay, motion.period))

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The delay, and where positions alone are known, the lag of the servo after it."""
        if len(shape) > 2:
            return {"delay": shape[1], "time_constant": shape[2]}
        return {"delay": shape[1]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """What comes late is what it is; the time within a factor."""
        what, time = shape[:2]
        first = [(what, what), (0.4 * time, min(2.5 * time, self.parameters[0].upper))]
        return [*first, (0.0, 0.5)] if len(shape) > 2 else first

    def negligible(self, motions: Sequence[Motion], shape: Shape) -> bool:
        """Whether it is less than the sampling can show."""
        return too_short(motions, shape)

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        first = (shape[0] if shape else OF_POSITION, values["delay"])
        lag = (values["time_constant"],) if "time_constant" in values else ()
        return (*first, *lag), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """What comes late."""
        return drive_variant(shape)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        if site.variant == "torque":
            return site.each(lambda j: DriveChange(joint=j, torque_delay=site["delay"]))
        lag = site.get("time_constant")  # of a servo of which positions alone are known
        return site.each(lambda j: DriveChange(joint=j, delay=site["delay"], command_lag=lag))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        late = f"Commands to {where} act {1e3 * values['delay']:.3g} ms late"
        lag = values.get("time_constant", 0.0)
        after = (
            f", and the servo follows with a lag of {1e3 * lag:.3g} ms"
            if lag > self.least_lag
            else ""
        )
        return late + after + "."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"fast changes of the command of {where}"
