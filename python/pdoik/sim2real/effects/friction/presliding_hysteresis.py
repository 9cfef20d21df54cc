"""Friction that builds up over a small displacement after each reversal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import Dahl, JointTorque, Part
from ..effect import Effect, Example, Parameter
from ..site import Site


def bristle(q: FloatArray, displacement: float) -> FloatArray:
    """Dahl's state z along positions q (T,): dz/dq = (1 - z sign(dq)) / displacement, exact."""
    steps = np.diff(q)
    decay = np.exp(-np.abs(steps) / displacement).tolist()
    aim = np.sign(steps).tolist()
    z = 0.0
    states = [z]
    for a, s in zip(decay, aim, strict=True):
        z = s + (z - s) * a
        states.append(z)
    return np.array(states)


_USUAL = 0.01  # displacement [rad]


class PreslidingHysteresis(Effect):
    """tau = L z, dz/dt = (dq/d) (1 - z sign(dq)) (Dahl, 1968)."""

    id = "presliding_hysteresis"
    family = "friction"
    on = "joint"
    equation = "tau = L z, dz/dt = (dq / d) (1 - z sign(dq))"
    parameters = (
        Parameter("level", "N m", lower=0.0),
        Parameter("displacement", "rad", lower=0.0),
    )
    confused_with = ("coulomb_friction", "backlash", "joint_elasticity")
    decided_by = "reversals of less than a degree at rest, several sizes"
    source = "Dahl, Aerospace Corp. TOR-158, 1968; Canudas de Wit et al., IEEE TAC 40(3), 1995"
    within = 0.3  # of the travel seen, up to which displacements are looked at
    example = Example(values={"level": 2.0, "displacement": 0.02})
    complexity = 2
    gated = True
    ordinary = True
    one_of = "dry"
    size_first = True
    makes_up_for_misfit = True
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Displacements over which friction builds up [rad]."""
        (j,) = place.joints
        span = max(float(np.ptp(m.q[:, j])) for m in motions)
        return [(d,) for d in (0.003, 0.008, 0.02, 0.05, 0.12) if d < self.within * span]

    def log_prior(self, shape: Shape) -> float:
        """Bristles of gears and bearings give way by a hundredth of a radian, give or take."""
        return -0.5 * float(np.log(max(shape[0], 1e-9) / _USUAL)) ** 2

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Dahl's state."""
        (j,) = place.joints
        return {("torque", j): bristle(motion.q[:, j], shape[0])[:, None]}

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The level is positive."""
        return np.zeros(1), np.full(1, np.inf)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Level and displacement."""
        return {"level": float(beta[0]), "displacement": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The level is linear, the displacement is not."""
        return (values["displacement"],), np.array([values["level"]])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        law = Dahl(site["level"], site["displacement"])
        return site.each(lambda j: JointTorque(joint=j, law=law))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"Friction of {where} ({values['level']:.3g} N m) does not change sign at once: after"
            f" a reversal it builds up over {values['displacement']:.2g} rad, as a spring does."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"just after reversals of {where}"
