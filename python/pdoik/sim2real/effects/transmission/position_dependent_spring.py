"""A spring on the joint: a cable, a counterbalance, a stop of rubber."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import DofChange, JointTorque, Part, spring
from ..effect import Effect, Example, Parameter
from ..site import Site


class PositionDependentSpring(Effect):
    """tau = k (q - q0), everywhere or only beyond its onset on one side."""

    id = "position_dependent_spring"
    name = "spring that depends on position"
    family = "transmission"
    on = "joint"
    equation = "tau = k (q - q0), everywhere (side 0) or only where side (q - q0) > 0"
    parameters = (
        Parameter("stiffness", "N m/rad", lower=0.0),
        Parameter("onset", "rad"),
        Parameter("side", "-", lower=-1.0, upper=1.0, chosen=True),
    )
    confused_with = ("link_inertial_error", "torque_offset", "joint_offset", "torque_ripple")
    decided_by = "slow motion through the whole range with the cable taken off"
    source = "a linear spring"
    least_range = 0.02  # of positions, in which an onset is looked for [rad]
    example = Example(values={"stiffness": 12.0, "onset": 0.4, "side": 1.0}, shape=(1.0, 0.4))
    complexity = 3
    against = "q"
    size_first = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Side and onset: within the angles that were visited."""
        (j,) = place.joints
        q = np.concatenate([m.q[:, j] for m in motions])
        if np.ptp(q) < self.least_range:
            return []
        high = np.quantile(q, (0.25, 0.5, 0.65, 0.8, 0.9, 0.96))
        low = np.quantile(q, (0.04, 0.1, 0.2, 0.35, 0.5, 0.75))
        sides: list[Shape] = [(0.0, 0.0)]
        sides += [(1.0, float(onset)) for onset in high]
        return sides + [(-1.0, float(onset)) for onset in low]

    def asked(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """A spring that acts everywhere."""
        return self.shapes(motions, place)[:1]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """The stretch."""
        (j,) = place.joints
        side, onset = shape
        q = motion.q[:, j]
        if side == 0.0:
            return {("torque", j): np.stack([q, np.ones_like(q)], axis=1)}
        return {("torque", j): (side * np.maximum(side * (q - onset), 0.0))[:, None]}

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Stiffness is positive; the constant of a full spring is free."""
        return np.array([0.0, -np.inf]), np.full(2, np.inf)

    def admissible(self, beta: FloatArray) -> bool:
        """Stiffness is positive."""
        return bool(beta[0] >= 0.0)

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """The side is what it is; the onset within a quarter of a radian."""
        side, onset = shape
        around = 0.0 if side == 0.0 else 0.25
        return [(side, side), (onset - around, onset + around)]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Stiffness, onset and side."""
        side, onset = shape
        stiffness = float(beta[0])
        if side == 0.0:
            onset = -float(beta[1]) / stiffness if stiffness > 0.0 else 0.0
        return {"stiffness": stiffness, "onset": onset, "side": side}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Coefficients; for a spring over the whole range the onset is a constant torque."""
        stiffness, onset, side = values["stiffness"], values["onset"], values["side"]
        if side == 0.0:
            return (0.0, 0.0), np.array([stiffness, -stiffness * onset])
        return (side, onset), np.array([stiffness])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        stiffness, onset, side = site["stiffness"], site.get("onset"), site.get("side")
        if side == 0:
            return site.each(lambda j: DofChange(joint=j, stiffness=stiffness, rest=onset))
        law = spring(stiffness, onset, side)
        return site.each(lambda j: JointTorque(joint=j, law=law, at_link=True))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        beyond = {0.0: "around", 1.0: "above", -1.0: "below"}[values["side"]]
        return (
            f"A spring of {values['stiffness']:.3g} N m/rad acts on {where} {beyond}"
            f" {values['onset']:.3g} rad: a cable, a counterbalance or a stop."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"part of the range of {where}, at any speed"
