"""Dry friction: the same whatever the speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, Part
from ..effect import Effect, Example, Parameter
from ..site import Site


class CoulombFriction(Effect):
    """tau = L sign(dq), smooth within a fitted speed of rest where data show it."""

    id = "coulomb_friction"
    name = "Coulomb friction"
    family = "friction"
    on = "joint"
    equation = "tau = L tanh(dq / v), v small"
    parameters = (Parameter("level", "N m", lower=0.0),)
    confused_with = ("presliding_hysteresis", "load_dependent_friction", "stribeck_friction")
    decided_by = "slow motion back and forth at two speeds, with reversals of a few degrees"
    source = "Armstrong-Helouvry et al., Automatica 30(7), 1994"
    example = Example(values={"level": 1.5}, shape=(0.02,))
    gated = True
    ordinary = True
    one_of = "dry"
    carries = ("viscous_friction",)
    size_first = True
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Speeds within which the sign turns [rad/s]."""
        return [(0.0,), (0.02,), (0.06,), (0.15,)]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Bounds of the speed [rad/s], from a step to what is nearly viscous."""
        return [(0.0, 0.3)]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The direction of motion."""
        (j,) = place.joints
        return {("torque", j): motion.sign(j, shape[0])[:, None]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The level; the speed of rest it was found with."""
        return shape or (0.0,), np.array([values["level"]])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: HardFriction(joint=j, level=site["level"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} has Coulomb friction of {values['level']:.3g} N m that is not in the model:"
            " the same torque against the motion at any speed."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"direction reversals of {where}"
