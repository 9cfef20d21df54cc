"""Torque that repeats with the joint's angle: cogging, gear teeth, a harmonic drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import JointTorque, Part, ripple
from ..effect import Effect, Example, Parameter
from ..site import Site


class TorqueRipple(Effect):
    """tau = A cos(h q + phase)."""

    id = "torque_ripple"
    family = "transmission"
    on = "joint"
    equation = "tau = A cos(h q + phase)"
    parameters = (
        Parameter("amplitude", "N m", lower=0.0),
        Parameter("phase", "rad"),
        Parameter("harmonic", "cycles per turn", lower=0.0, upper=1000.0, chosen=True),
    )
    confused_with = ("position_dependent_spring", "strain_wave_error")
    decided_by = "slow constant speed over a whole turn: ripple repeats with the angle"
    source = "Tjahjowidodo et al. 2013; Zhang et al., ICRA 2015 (harmonic drive torque ripple)"
    example = Example(values={"amplitude": 0.6, "phase": 0.7, "harmonic": 24.0})
    complexity = 4
    against = "q"
    sought = "harmonics"
    gated = True
    size_first = True

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Cosine and sine of the angle's multiple."""
        (j,) = place.joints
        angle = shape[0] * motion.q[:, j]
        return {("torque", j): np.stack([np.cos(angle), np.sin(angle)], axis=1)}

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """None: harmonics are looked for in the residual's spectrum over the angle."""
        return []

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Any phase."""
        return np.full(2, -np.inf), np.full(2, np.inf)

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Within half a cycle per turn."""
        return [(shape[0] - 0.5, shape[0] + 0.5)]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Amplitude, phase and cycles per turn."""
        amplitude = float(np.hypot(beta[0], beta[1]))
        phase = float(np.arctan2(-beta[1], beta[0]))
        return {"amplitude": amplitude, "phase": phase, "harmonic": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Coefficients of cosine and sine, (2,) [N m]."""
        amplitude, phase = values["amplitude"], values["phase"]
        beta = amplitude * np.array([np.cos(phase), -np.sin(phase)])
        return (values["harmonic"],), beta

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        law = ripple(site["amplitude"], site.get("phase"), site["harmonic"])
        return site.each(lambda j: JointTorque(joint=j, law=law))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The torque of {where} ripples by {values['amplitude']:.3g} N m,"
            f" {values['harmonic']:.4g} times per turn."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"any motion of {where}, repeating with its angle"
