"""A gear that wastes another share of the load when it drives than when it is driven."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, Part, of_driven_load
from ..effect import Effect, Example, Parameter
from ..site import Site


class GearEfficiency(Effect):
    """tau = c |tau_load| sign(dq), c by whether the motor drives the load or the load the motor.

    With an efficiency e of a gear that drives, c = 1/e - 1; with e' of one that is driven,
    c = 1 - e'. Where both are one figure it is load-dependent friction, which is simpler.
    """

    id = "gear_efficiency"
    name = "gear efficiency by direction of power"
    family = "transmission"
    on = "joint"
    equation = "tau = c |tau_load| sign(dq), c = driving_loss where tau_load dq > 0, else driven"
    parameters = (
        Parameter("driving_loss", "-", lower=0.0, upper=3.0),
        Parameter("driven_loss", "-", lower=0.0, upper=1.0),
    )
    confused_with = ("load_dependent_friction", "torque_gain", "coulomb_friction")
    decided_by = "the same weight lifted and let down slowly, at two or more weights"
    source = "Wang and Kim, ICRA 2015 (directional efficiency in geared transmissions)"
    least_each_way = 0.1  # of the moving load's mean square that must be seen each way
    example = Example(values={"driving_loss": 0.1, "driven_loss": 0.3})
    odds = 0.1
    complexity = 3
    against = "load"
    ordinary = True
    one_of = "by load"
    jumps = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Transmitted torque times direction, apart by the way power goes."""
        (j,) = place.joints
        load = motion.load(j)
        column = np.abs(load) * motion.sign(j)
        drives = load * motion.dq[:, j] > 0.0
        return {("torque", j): np.stack([column * drives, column * ~drives], axis=1)}

    def plausible(self, motions: Sequence[Motion], place: Place, shape: Shape) -> bool:
        """Whether the recordings have both: a load that is moved, and one that moves."""
        parts = np.concatenate(
            [self.columns(m, place, shape)["torque", place.joints[0]] for m in motions]
        )
        squares = np.mean(parts**2, axis=0)
        return bool(squares.min() > self.least_each_way * squares.sum())

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = of_driven_load(site["driving_loss"], site["driven_loss"])
        return site.each(lambda j: HardFriction(joint=j, level=level, needs_load=True))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The gear of {where} loses {100 * values['driving_loss']:.2g} % of the load when it"
            f" drives it, and {100 * values['driven_loss']:.2g} % when the load drives the motor."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"motion of {where} under load, lifting and letting down"
