"""A strain-wave gear whose output runs ahead and behind, twice per turn of its input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import GearPlay, Part, Wave
from ..effect import Effect, Example, Parameter, on_torque_and_tip, tip_turned
from ..site import Site

_LEAST, _MOST = 20.0, 1000.0  # cycles per turn: gear ratios of 10 to 500
_LARGEST = 0.02  # no gear is worse [rad]


class StrainWaveError(Effect):
    """q_link = q + A sin(h q + phase), h = 2 N for a gear of ratio N; the encoder is the motor's.

    The link's speeding up and slowing down takes A h^2 dq^2 of its inertia, which grows with speed
    squared where a ripple of torque does not; and the motor feels the slope: (1 + A h cos) tau.
    """

    id = "strain_wave_error"
    name = "position error of a strain-wave gear"
    family = "transmission"
    on = "joint"
    equation = "q_link = q + A sin(h q + phase), h = 2 N; tau = (1 + A h cos(h q + phase)) tau_link"
    parameters = (
        Parameter("amplitude", "rad", lower=0.0, upper=_LARGEST),
        Parameter("phase", "rad"),
        Parameter("harmonic", "cycles per turn", lower=0.0, upper=_MOST, chosen=True),
    )
    confused_with = ("torque_ripple", "joint_elasticity")
    decided_by = (
        "the same motion at half the speed: a ripple stays, a position error's torque falls"
    )
    source = "Tuttle and Seering, IEEE T-RA 12(3), 1996 (kinematic error of harmonic drives)"
    example = Example(values={"amplitude": 2e-3, "phase": 0.7, "harmonic": 100.0})
    complexity = 4.5
    against = "q"
    sought = "harmonics"

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Columns of a link that is further by the angle's sine, and by its cosine, per radian."""
        (j,) = place.joints
        h = shape[0]
        if motion.body is None or h < _LEAST:
            return {}
        q, dq, ddq = motion.q[:, j], motion.dq[:, j], motion.ddq[:, j]
        sine, cosine = np.sin(h * q), np.cos(h * q)
        both = [
            _moved(motion, j, value, h * slope, dq, ddq, h)
            for value, slope in ((sine, cosine), (cosine, -sine))
        ]
        return {key: np.hstack([each[key] for each in both]) for key in both[0]}

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """None: harmonics are looked for in the residual's spectrum over the angle."""
        return []

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Any phase."""
        return np.full(2, -_LARGEST), np.full(2, _LARGEST)

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Within half a cycle per turn."""
        return [(shape[0] - 0.5, shape[0] + 0.5)]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Amplitude, phase and cycles per turn."""
        amplitude, phase = float(np.hypot(*beta)), float(np.arctan2(beta[1], beta[0]))
        return {"amplitude": amplitude, "phase": phase, "harmonic": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """Coefficients of sine and cosine, (2,) [rad]."""
        amplitude, phase = values["amplitude"], values["phase"]
        return (values["harmonic"],), amplitude * np.array([np.cos(phase), np.sin(phase)])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        wave = Wave(amplitude=site["amplitude"], harmonic=site["harmonic"], phase=site.get("phase"))
        return site.each(lambda j: GearPlay(joint=j, waves=(wave,)))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The link of {where} runs {values['amplitude']:.3g} rad ahead of its motor and behind"
            f" it, {values['harmonic']:.4g} times per turn: a strain-wave gear of ratio"
            f" {values['harmonic'] / 2:.4g}, if it is one."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"fast motion of {where}, repeating with its angle"


def _moved(
    motion: Motion,
    j: int,
    value: FloatArray,
    slope: FloatArray,
    dq: FloatArray,
    ddq: FloatArray,
    harmonic: float,
) -> Columns:
    """What changes where the link is `value` (T,) further, which has this slope over q (T,)."""
    acceleration = slope * ddq - harmonic**2 * value * dq**2
    torque = motion.by_motion(j, value, slope * dq, acceleration)
    # The rotor stays with the motor; what the link needs comes by the slope of its place.
    torque[:, j] += slope * motion.load(j)
    return on_torque_and_tip(motion, torque, tip_turned(motion, j, value))
