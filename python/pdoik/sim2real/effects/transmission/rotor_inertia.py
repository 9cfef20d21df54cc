"""Inertia of the rotor, seen through the gear."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...motion import Columns, Motion, Place, Shape
from ...simulation import DofChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site


class RotorInertia(Effect):
    """tau = I ddq of the joint alone, in addition to what the model has."""

    id = "rotor_inertia"
    family = "body"
    on = "joint"
    equation = "tau = I ddq"
    parameters = (Parameter("inertia", "kg m^2", lower=0.0),)
    confused_with = ("link_inertial_error", "torque_gain")
    decided_by = (
        "quick motion of this joint with the arm in different poses and of the joint before"
    )
    source = "Featherstone, Rigid Body Dynamics Algorithms, 2008, Sec. 9.6"
    trifle = 5e-3  # of what the joint accelerates anyway
    example = Example(values={"inertia": 0.2})
    ordinary = True
    size_first = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The joint's acceleration."""
        (j,) = place.joints
        return {("torque", j): motion.ddq[:, j, None]}

    def trifling(self, values: Mapping[str, float], motion: Motion, place: Place) -> bool:
        """Less than half a percent of what the joint accelerates anyway."""
        (j,) = place.joints
        if motion.body is None:
            return False
        carried = motion.body.rotor[j] + float(np.mean(motion.mass_matrix[:, j, j]))
        return bool(values["inertia"] < self.trifle * carried)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: DofChange(joint=j, armature=site["inertia"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} resists acceleration by {values['inertia']:.3g} kg m^2 more than its links"
            " do: the rotor's inertia through the gear."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"acceleration of {where}"
