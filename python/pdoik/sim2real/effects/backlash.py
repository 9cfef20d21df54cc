"""Play in the gear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion import Motion
from ..recording import FloatArray
from ..signals import zero_phase
from .effect import Columns, Effect, Parameter, Place, Shape
from .joint_elasticity import deflected


class Backlash(Effect):
    """The link stands half the gap behind its motor, on the side that the load pushes it to."""

    id = "backlash"
    on = "joint"
    equation = "q_link = q - (gap / 2) sign(tau_load)"
    parameters = (Parameter("gap", "rad", lower=0.0),)
    confused_with = ("joint_elasticity", "presliding_hysteresis", "coulomb_friction")
    decided_by = "slow motion through the pose where the joint's load changes its sign"
    source = "Nordin and Gutman, Automatica 38(10), 2002"
    complexity = 3

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Load below which the link hangs between the flanks, relative to the usual load."""
        return [(0.02,), (0.1,)]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Of a deflection by the load's sign, per gap."""
        (j,) = place.joints
        load = zero_phase(motion.tau[:, j] - motion.rotor(j), 2 * motion.cutoff, motion.period)
        usual = float(np.sqrt(np.mean(load**2))) or 1.0
        return deflected(motion, j, 0.5 * np.tanh(load / (shape[0] * usual)))

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The gap is positive."""
        return np.zeros(1), np.full(1, 0.5)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The whole gap."""
        return {"gap": float(beta[0])}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return (
            f"{where} has play: {np.degrees(values['gap']):.2g} degrees lie between the two flanks"
            " of its gear."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"changes of the sign of the load of {where}"
