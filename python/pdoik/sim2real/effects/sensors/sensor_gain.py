"""A channel that is wrong by a factor: speed or position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import Part, SensedChannel, SensorChange
from ..effect import Effect, Example, Parameter, on_torque_and_tip, tip_turned
from ..site import Site

OF_LOGGED_SPEED, OF_POSITION, OF_LOGGED_POSITION, OF_SPEED = 0.0, 1.0, 2.0, 3.0
"""What reads wrong: the controller's sensor too, or the log alone."""

_LOGGED = "logged "
"""Begins the variant of what is wrong in the log alone."""

_CHANNELS: dict[str, SensedChannel] = {"position": "q", "speed": "dq", "torque": "tau"}

_STEP = 1e-4  # of gravity's derivative [rad]


class SensorGain(Effect):
    """logged = k true, in the sensor or the log alone; of torque see torque_gain."""

    id = "sensor_gain"
    family = "sensor"
    on = "channel"
    equation = "logged = k true"
    parameters = (Parameter("gain", "-"),)
    confused_with = ("torque_gain", "kinematic_error", "joint_offset")
    decided_by = "the channel compared with a second instrument"
    source = "sensor calibration"
    trifle = 5e-3  # a gain off by less is as good as right
    example = Example(values={"gain": 1.03}, shape=(OF_LOGGED_SPEED,), nothing={"gain": 1.0})
    complexity = 2
    makes_up_for_misfit = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Channels; in the log alone where a law shows that the controller reads another."""
        (j,) = place.joints
        speed = motions[0].measured_dq
        shapes: list[Shape] = []
        if speed is not None and _known(speed[:, j]):
            shapes += [(OF_LOGGED_SPEED,), (OF_SPEED,)]
        if motions[0].body is not None:
            shapes += [(OF_POSITION,), (OF_LOGGED_POSITION,)]
        return shapes

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The channel, or the derivatives by position times it."""
        (j,) = place.joints
        q, dq, ddq = motion.q[:, j], motion.dq[:, j], motion.ddq[:, j]
        if shape[0] == OF_SPEED:
            return {("velocity", j): dq[:, None]}
        if shape[0] == OF_LOGGED_SPEED:
            return {("velocity", j): dq[:, None], **through_law(motion, j, dq)}
        # The true position is q / k = q + b q: coefficient b = 1/k - 1. Where speed was measured
        # apart it stays right, and the balance of speed sees the positions' derivative grow.
        columns = on_torque_and_tip(
            motion, motion.by_motion(j, q, dq, ddq), tip_turned(motion, j, q)
        )
        if motion.measured_dq is not None and _known(motion.measured_dq[:, j]):
            columns["velocity", j] = dq[:, None]
        if shape[0] == OF_LOGGED_POSITION:
            return added(columns, law_of_position(motion, j, q))
        return columns

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Coefficient k - 1, or 1/k - 1."""
        return np.full(1, -3.0), np.full(1, 200.0)

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """The channel is what it is."""
        return [(shape[0], shape[0])]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The gain."""
        by_one = 1.0 + float(beta[0])
        return {"gain": 1.0 / by_one if _of_position(shape) else by_one}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Shape, and the coefficient (1,), a gain's difference from one, see `columns`."""
        shape, gain = shape or (OF_LOGGED_SPEED,), values["gain"]
        return shape, np.array([1.0 / gain - 1.0 if _of_position(shape) else gain - 1.0])

    def variant(self, shape: Shape) -> str:
        """The channel."""
        what = "position" if _of_position(shape) else "speed"
        return what if shape[0] in (OF_SPEED, OF_POSITION) else f"{_LOGGED}{what}"

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Less than half a percent."""
        return abs(values["gain"] - 1.0) < self.trifle

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        channel, log_only = channel_of(site.variant, "dq"), site.variant.startswith(_LOGGED)
        return site.each(
            lambda j: SensorChange(joint=j, channel=channel, gain=site["gain"], log_only=log_only)
        )

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return f"A sensor of {where} reads {values['gain']:.3g} times the true value."


def channel_of(variant: str, default: SensedChannel) -> SensedChannel:
    """The channel that a variant names."""
    return _CHANNELS.get(variant.removeprefix(_LOGGED), default)


def through_law(motion: Motion, j: int, speed_error: FloatArray) -> Columns:
    """Where the controller's law is worked out with a logged speed that is off by so much (T,)."""
    if motion.controller is None or motion.law is None:
        return {}
    torque = (motion.controller.kd[j] * speed_error)[:, None]
    return {("law", j): torque} if motion.has_law(j) else {("torque", j): -torque}


def law_of_position(motion: Motion, j: int, change: FloatArray) -> Columns:
    """Where the law is worked out with a position that is truly `change` (T,) more."""
    controller = motion.controller
    if controller is None or motion.law is None:
        return {}
    torque = np.zeros_like(motion.q)
    torque[:, j] = -controller.kp[j] * change
    if controller.gravity_compensation and motion.believed is not None:
        moved = motion.q.copy()
        moved[:, j] += _STEP
        believed = motion.believed
        slope = (believed.gravity(moved) - believed.gravity(motion.q)) / _STEP
        torque += slope * change[:, None]
    columns: Columns = {}
    for i in np.flatnonzero(np.any(torque != 0.0, axis=0)):
        sign, balance = (1.0, "law") if motion.has_law(int(i)) else (-1.0, "torque")
        columns[balance, int(i)] = sign * torque[:, i, None]  # type: ignore[index]
    return columns


def added(one: Columns, other: Columns) -> Columns:
    """Both, summed where they change the same."""
    both = {key: one[key] + other[key] for key in one.keys() & other.keys()}
    return {**one, **other, **both}


def _of_position(shape: Shape) -> bool:
    return shape[0] in (OF_POSITION, OF_LOGGED_POSITION)


def _known(values: FloatArray) -> bool:
    return bool(np.isfinite(values).all())
