"""Dry friction that falls while the joint warms up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import HardFriction, Part, drift
from ..effect import Effect, Example, Parameter
from ..site import Site


class FrictionDrift(Effect):
    """tau = D exp(-t/T) sign(dq), t from the recording's start."""

    id = "friction_drift"
    family = "friction"
    on = "joint"
    part_of = ("coulomb_friction", 2.0)  # cold grease: up to three times as much
    equation = "tau = D exp(-t / T) sign(dq)"
    parameters = (
        Parameter("extra", "N m", lower=0.0),
        Parameter("time_constant", "s", lower=0.0),
    )
    confused_with = ("coulomb_friction", "viscous_friction")
    decided_by = "the same motion repeated for half an hour from cold"
    source = "Simoni et al., IROS 2015 (friction of robot joints and temperature)"
    example = Example(
        values={"extra": 1.5, "time_constant": 4.0},
        beside={"coulomb_friction": {"level": 1.0}},
    )
    complexity = 3
    ordinary = True
    size_first = True
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Times over which it fades, within the recordings' length [s]."""
        longest = max(float(m.time[-1]) for m in motions)
        return [(share * longest,) for share in (0.1, 0.2, 0.4, 0.8, 2.0)]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Direction, fading with time."""
        (j,) = place.joints
        column = motion.sign(j) * np.exp(-(motion.since + motion.time) / shape[0])
        return {("torque", j): column[:, None]}

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The surplus is positive: friction falls."""
        return np.zeros(1), np.full(1, np.inf)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Surplus at the start and the time over which it fades."""
        return {"extra": float(beta[0]), "time_constant": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The surplus is linear, its time constant is not."""
        return (values["time_constant"],), np.array([values["extra"]])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        level = drift(site["extra"], site["time_constant"])
        return site.each(lambda j: HardFriction(joint=j, level=level))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"Friction of {where} is {values['extra']:.3g} N m higher at the start of a recording"
            f" and decreases over about {values['time_constant']:.2g} s: it warms up."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"the first part of each recording, {where} moving"
