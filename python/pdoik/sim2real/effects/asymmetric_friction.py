"""Friction that differs between the two directions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..motion.motion import Motion
from ..motion.place import Columns, Place, Shape
from ..simulation.laws import level_asymmetry, viscous_asymmetry
from ..simulation.parts import HardFriction, JointTorque, Part
from .effect import Effect, Example, Parameter
from .site import Site


class AsymmetricFriction(Effect):
    """tau = (dL |sign(dq)| + dc |dq|) / 2: forwards less backwards, beside the symmetric part."""

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

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Whether it moves, and how fast."""
        (j,) = place.joints
        moving = np.abs(np.tanh(motion.dq[:, j] / (0.05 * motion.speed_floor[j])))
        return {("torque", j): 0.5 * np.stack([moving, np.abs(motion.dq[:, j])], axis=1)}

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = level_asymmetry(site.get("level_difference"))
        viscous = viscous_asymmetry(site.get("viscous_difference"))
        return site.each(lambda j: HardFriction(joint=j, level=level)) + site.each(
            lambda j: JointTorque(joint=j, law=viscous)
        )

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return (
            f"Friction of {where} differs between the two directions: forwards less backwards"
            f" {values['level_difference']:.3g} N m and {values['viscous_difference']:.3g} N m per"
            " rad/s."
        )
