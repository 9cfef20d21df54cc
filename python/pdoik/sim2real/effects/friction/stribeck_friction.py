"""Dry friction that is higher at low speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, Part, stribeck
from ..effect import Effect, Example, Parameter
from ..site import Site


class StribeckFriction(Effect):
    """tau = S sign(dq) exp(-(dq/v)^2) with S > 0: a negative S is smooth dry friction, not this."""

    id = "stribeck_friction"
    name = "Stribeck friction"
    family = "friction"
    on = "joint"
    odds = 0.1
    equation = "tau = S sign(dq) exp(-(dq / v)^2), in addition to Coulomb's"
    parameters = (Parameter("extra", "N m", lower=0.0), Parameter("speed", "rad/s", lower=0.0))
    confused_with = ("coulomb_friction", "presliding_hysteresis", "asymmetric_friction")
    decided_by = "constant slow speeds, in steps from a hundredth to a third of the rated speed"
    source = "Bo and Pavelescu, Wear 82(3), 1982"
    within = 0.5  # of the fastest motion, up to which speeds are looked at
    example = Example(values={"extra": 1.5, "speed": 0.3})
    complexity = 3
    ordinary = True
    size_first = True
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Speeds at which the extra friction fades, within what the recordings contain."""
        (j,) = place.joints
        fastest = max(float(np.quantile(np.abs(m.dq[:, j]), 0.98)) for m in motions)
        slowest = 5.0 * max(float(m.speed_floor[j]) for m in motions)
        grid = (0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
        return [(v,) for v in grid if slowest < v < self.within * fastest]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Direction, fading with speed."""
        (j,) = place.joints
        fade = np.exp(-((motion.dq[:, j] / shape[0]) ** 2))
        return {("torque", j): (motion.sign(j) * fade)[:, None]}

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The extra friction is positive."""
        return np.zeros(1), np.full(1, np.inf)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Extra friction at rest and the speed at which it fades."""
        return {"extra": float(beta[0]), "speed": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The extra friction is linear, the speed is not."""
        return (values["speed"],), np.array([values["extra"]])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = stribeck(site["extra"], site["speed"])
        return site.each(lambda j: HardFriction(joint=j, level=level))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} has {values['extra']:.3g} N m more dry friction near rest than at speed; the"
            f" difference disappears above about {values['speed']:.2g} rad/s (Stribeck)."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"slow motion of {where}"
