"""A drive that gives no more than a certain torque, whatever it is told."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from .effect import Columns, Effect, Parameter, Place, Shape


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
    complexity = 2

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Levels below the highest torque asked for."""
        (j,) = place.joints
        asked = np.concatenate([np.abs(_asked(m)[:, j]) for m in motions])
        if not np.isfinite(asked).any():
            return []
        levels = np.nanquantile(asked, (0.7, 0.85, 0.93, 0.97, 0.985, 0.993, 0.997, 0.999))
        return [(float(level),) for level in levels if level > 0.0]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What is missing beyond the level, of the recorded torque or of the command."""
        (j,) = place.joints
        asked = _asked(motion)[:, j]
        beyond = asked - np.clip(asked, -shape[0], shape[0])
        if motion.command is not None and np.isfinite(motion.command[:, j]).all():
            return {("drive", j): -beyond[:, None]}
        return {("torque", j): beyond[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The level."""
        return {"level": shape[0]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Near the level found first."""
        return [(0.8 * shape[0], 1.25 * shape[0])]

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return f"The drive of {where} gives at most {values['level']:.3g} N m, whatever is asked."

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"the highest torques of {where}"


def _asked(motion: Motion) -> FloatArray:
    """Commanded torque, else what stands for the torque."""
    asked = motion.torque if motion.command is None else motion.command
    assert asked is not None
    return asked
