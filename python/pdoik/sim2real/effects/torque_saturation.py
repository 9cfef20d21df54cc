"""A drive that gives no more than a certain torque, whatever it is told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from ..signals import zero_phase
from .effect import Columns, Effect, Parameter, Place, Shape

_LEAST_REACHED = 12  # samples
OF_REPORTED, OF_COMMAND, OF_LAW = 0.0, 1.0, 2.0
"""First entry of a shape: what is larger than the torque truly given."""


class TorqueSaturation(Effect):
    """tau = clip(tau_cmd, -L, L)."""

    id = "torque_saturation"
    on = "joint"
    equation = "tau = clip(tau_cmd, -L, L)"
    parameters = (Parameter("level", "N m", lower=0.0),)
    confused_with = ("torque_gain", "actuator_lag")
    decided_by = "one motion that asks for more torque than this, recorded beside its command"
    source = "drive data sheet"
    fixed = True
    least_of_rest = 0.5
    complexity = 2

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """What is clipped, and levels below the highest torque asked for."""
        (j,) = place.joints
        first = motions[0]
        kinds = [OF_REPORTED] if first.source else []
        kinds += [OF_COMMAND] if first.has_command(j) else []
        kinds += [OF_LAW] if first.has_law(j) else []
        shapes: list[Shape] = []
        for kind in kinds:
            asked = np.concatenate([np.abs(_asked(m, j, kind)) for m in motions])
            if np.isfinite(asked).all():
                levels = np.quantile(asked, (0.7, 0.85, 0.93, 0.97, 0.985, 0.993, 0.997, 0.999))
                # A limit that is rarely reached lies between these: at the highest torque given.
                if kind != OF_REPORTED:
                    levels = np.append(levels, max(_highest(m, j, kind) for m in motions))
                shapes += [(kind, float(level)) for level in levels if level > 0.0]
        return shapes

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What is missing beyond the level."""
        (j,) = place.joints
        kind, level = shape
        asked = _asked(motion, j, kind)
        beyond = asked - np.clip(asked, -level, level)
        if kind == OF_COMMAND:
            return {("drive", j): -beyond[:, None]}
        if kind == OF_LAW:
            return {("law", j): -beyond[:, None]}
        return {("torque", j): beyond[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The level."""
        return {"level": shape[1]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Near the level found first."""
        kind, level = shape
        return [(kind, kind), (0.8 * level, 1.25 * level)]

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        return (shape[0] if shape else OF_COMMAND, values["level"]), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """What is larger than the torque given."""
        return {OF_REPORTED: "reported torque", OF_COMMAND: "command", OF_LAW: "law"}[shape[0]]

    def plausible(self, motions: Sequence[Motion], place: Place, shape: Shape) -> bool:
        """Nowhere does the joint get more than the level, noise apart."""
        (j,) = place.joints
        kind, level = shape
        highest = max(_highest(m, j, kind) for m in motions)
        if kind == OF_REPORTED and highest < 0.8 * level:
            return False  # the joint never needed as much: what is cut off is not torque
        asked = np.concatenate([np.abs(_asked(m, j, kind)) for m in motions])
        reached = int(np.count_nonzero(asked > level))
        return highest < 1.06 * level and reached >= _LEAST_REACHED

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"The drive of {where} gives at most {values['level']:.3g} N m, whatever is asked."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"the highest torques of {where}"


def _asked(motion: Motion, j: int, kind: float) -> FloatArray:
    """The torque that is clipped, (T,)."""
    asked = {OF_REPORTED: motion.torque, OF_COMMAND: motion.command, OF_LAW: motion.law}[kind]
    assert asked is not None
    return np.ascontiguousarray(asked[:, j])


def _highest(motion: Motion, j: int, kind: float) -> float:
    """The highest torque truly given, noise apart [N m]."""
    given = motion.tau[:, j] if kind == OF_REPORTED else motion.given(j)
    if kind == OF_COMMAND and motion.torque is not None:
        given = motion.torque[:, j]
    smooth = np.abs(zero_phase(given, motion.cutoff, motion.period))
    return float(np.quantile(smooth, 0.9995))
