"""Friction that differs between the two directions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, JointTorque, Part, level_asymmetry, viscous_asymmetry
from ..effect import Effect, Example, Parameter
from ..site import Site

_LEVEL = (0.0,)  # the shape of a difference of levels alone


class AsymmetricFriction(Effect):
    """tau = (dL |sign(dq)| + dc |dq|) / 2: forwards less backwards, besides the symmetric part.

    Or of levels alone: what need not be there is not paid for besides an offset of the torque.
    """

    id = "asymmetric_friction"
    family = "friction"
    on = "joint"
    odds = 0.05
    equation = "tau = (dL |sign(dq)| + dc |dq|) / 2"
    parameters = (
        Parameter("level_difference", "N m"),
        Parameter("viscous_difference", "N m s/rad"),
    )
    confused_with = ("torque_offset", "link_inertial_error", "gravity_direction")
    decided_by = "rests between motions in both directions: an offset stays at rest, friction not"
    source = "Armstrong-Helouvry et al., Automatica 30(7), 1994"
    example = Example(
        values={"level_difference": 0.8, "viscous_difference": 0.5},
        beside={"coulomb_friction": {"level": 1.5}},
    )
    complexity = 3
    ordinary = True
    one_of = "one way"
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Shapes of levels and of slopes, or of levels alone."""
        return [(), _LEVEL]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """None: which of both it is cannot be moved."""
        return [(value, value) for value in shape]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """One for each coefficient."""
        return {each.name: float(b) for each, b in zip(self.parameters, beta, strict=False)}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Coefficients of those parameters that are given."""
        known = [values[each.name] for each in self.parameters if each.name in values]
        return () if len(known) > 1 else _LEVEL, np.array(known)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Whether it moves, and how fast."""
        (j,) = place.joints
        moving = np.abs(np.tanh(motion.dq[:, j] / (0.05 * motion.speed_floor[j])))
        both = 0.5 * np.stack([moving, np.abs(motion.dq[:, j])], axis=1)
        return {("torque", j): both[:, :1] if shape == _LEVEL else both}

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = level_asymmetry(site.get("level_difference"))
        viscous = viscous_asymmetry(site.get("viscous_difference"))
        return site.each(lambda j: HardFriction(joint=j, level=level)) + site.each(
            lambda j: JointTorque(joint=j, law=viscous)
        )

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        more = f"{values['level_difference']:.3g} N m"
        if "viscous_difference" in values:
            more += f" and {values['viscous_difference']:.3g} N m per rad/s"
        return (
            f"Friction of {where} differs between the two directions: forwards less backwards"
            f" {more}."
        )
