"""Friction that grows with speed."""

from __future__ import annotations

from collections.abc import Mapping

from ...motion import Columns, Motion, Place, Shape
from ...simulation import DofChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site


class ViscousFriction(Effect):
    """tau = c dq (Siciliano et al., Robotics, 2009, Sec. 7.1)."""

    id = "viscous_friction"
    family = "friction"
    on = "joint"
    equation = "tau = c dq"
    parameters = (Parameter("coefficient", "N m s/rad", lower=0.0),)
    confused_with = ("stribeck_friction", "asymmetric_friction", "torque_gain")
    decided_by = "both directions at five or more constant speeds over the whole range"
    source = "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, Sec. 7.1"
    example = Example(values={"coefficient": 1.2})
    gated = True
    ordinary = True
    carries = ("coulomb_friction",)
    size_first = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The joint's speed."""
        (j,) = place.joints
        return {("torque", j): motion.dq[:, j, None]}

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: DofChange(joint=j, damping=site["coefficient"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} has viscous friction of {values['coefficient']:.3g} N m for every rad/s of"
            " speed that is not in the model."
        )
