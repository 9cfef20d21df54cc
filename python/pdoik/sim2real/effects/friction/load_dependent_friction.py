"""Dry friction that grows with the torque the gear transmits."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, Part, of_load
from ..effect import Effect, Example, Parameter
from ..site import Site


class LoadDependentFriction(Effect):
    """tau = c |tau_load| sign(dq)."""

    id = "load_dependent_friction"
    name = "load-dependent friction"
    family = "friction"
    on = "joint"
    odds = 0.15
    equation = "tau = c |tau_load| sign(dq)"
    parameters = (Parameter("coefficient", "-", lower=0.0, upper=1.0),)
    confused_with = ("coulomb_friction", "torque_gain", "gear_efficiency")
    decided_by = "the same slow motion back and forth with the arm stretched out and folded"
    source = "Hamon et al., ICRA 2010 (load-dependent friction in robot dynamics)"
    example = Example(values={"coefficient": 0.15})
    complexity = 2
    against = "load"
    gated = True
    ordinary = True
    one_of = "by load"
    size_first = True
    jumps = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Transmitted torque times direction."""
        (j,) = place.joints
        column = np.abs(motion.load(j)) * motion.sign(j)
        return {("torque", j): column[:, None]}

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = of_load(site["coefficient"])
        return site.each(lambda j: HardFriction(joint=j, level=level, needs_load=True))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"Friction of {where} grows with its load: {100 * values['coefficient']:.2g} % of the"
            " torque that it transmits is lost."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"reversals of {where} under load"
