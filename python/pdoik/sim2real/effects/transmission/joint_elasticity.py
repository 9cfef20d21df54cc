"""A spring between motor and link."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.linalg import lapack

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import GearPlay, Part
from ..effect import Effect, Example, Parameter, on_torque_and_tip, tip_turned
from ..site import Site

_SLOWEST = 1.2  # at which a link rings that is looked for [Hz]
_RATES = 14  # stiffnesses that are tried first
_STIFF, _FARTHER = 6, 1.5  # more that do not ring, and how far apart their frequencies are
_RATIO = 0.15  # of their damping
_LIGHTEST = 1e-6  # [kg m^2]


def deflected(motion: Motion, j: int, deflection: FloatArray) -> Columns:
    """What a link that lags its motor by `deflection` (T,) changes in torques and tip."""
    change = motion.by_deflection(deflection, j)
    return on_torque_and_tip(motion, change, tip_turned(motion, j, -deflection))


def given_way(
    load: FloatArray, inertia: FloatArray, period: float, stiffness: float, damping: float
) -> FloatArray:
    """How far a link lags its motor behind a spring, (T,): I u'' + d u' + k u = load.

    The average acceleration of a step, which no stiffness makes unstable (Newmark, J. Eng. Mech.
    Div. 85(3), 1959); inertias are such that the spring rings as fast as it should.

    Args:
        load: (T,) torque that a rigid gear would transmit [N m].
        inertia: (T,) of the link about its joint [kg m^2].
        period: of the samples [s].
        stiffness: of the spring [N m/rad].
        damping: in parallel with the spring [N m s/rad].
    """
    half = np.minimum(0.5 * period * np.sqrt(stiffness / inertia), 1.5)
    heavy = inertia * (half / np.tan(half)) ** 2 / period**2
    rows = np.zeros((3, len(load)))  # of a lower triangle: below one another what multiplies u
    rows[0, 2:] = (heavy + 0.5 * damping / period)[1:-1] + 0.25 * stiffness
    rows[1, 1:-1] = 0.5 * stiffness - 2.0 * heavy[1:-1]
    rows[2, :-2] = (heavy - 0.5 * damping / period)[1:-1] + 0.25 * stiffness
    rows[0, :2], rows[1, 0] = 1.0, 0.0
    right = np.empty(len(load))
    right[:2] = load[:2] / stiffness  # at rest on the spring
    right[2:] = 0.25 * (load[:-2] + 2.0 * load[1:-1] + load[2:])
    return np.asarray(lapack.dtbtrs(rows, right[:, None], uplo="L")[0][:, 0])


class JointElasticity(Effect):
    """A link on a spring, which the model's load drives; the encoder is on the motor."""

    id = "joint_elasticity"
    family = "transmission"
    on = "joint"
    equation = "I u'' + d u' + k u = tau_rigid, u = q - q_link: two inertias and a spring"
    parameters = (
        Parameter("stiffness", "N m/rad", lower=0.0),
        Parameter("damping", "N m s/rad", lower=0.0),
    )
    confused_with = ("backlash", "rotor_inertia", "presliding_hysteresis")
    decided_by = "a quick stop, sampled at 500 Hz or more: the ring's frequency is sqrt(k / I)"
    source = "Spong, ASME J. Dyn. Sys. 109(4), 1987"
    example = Example(
        values={"stiffness": 400.0, "damping": 2.0},
        nothing={"stiffness": 1e12, "damping": 0.0},
    )
    instead = ("backlash",)
    odds = 0.1  # strain-wave gears and belts give
    fixed = True
    reach = (0.4, 2.5)
    shown_poorly = True
    simplified = 0.1  # it rings by an inertia, which is a drawing's: to a tenth
    simulated_rivals = ("backlash",)
    complexity = 3

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Stiffness, and damping over stiffness: the time the spring takes to give [s].

        Such that the link rings at frequencies from a slow motion's to the fastest that is seen;
        and stiffer ones, farther apart: it gives by its load alone.
        """
        (j,) = place.joints
        inertia = float(np.mean(np.concatenate([_inertia(m, j) for m in motions])))
        seen = 2.0 * motions[0].cutoff
        stiff = seen * _FARTHER ** np.arange(1, _STIFF + 1)
        rates = 2.0 * np.pi * np.concatenate([np.geomspace(_SLOWEST, seen, _RATES), stiff])
        return [(float(inertia * rate**2), float(2.0 * _RATIO / rate)) for rate in rates]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Bounds: the neighbouring springs that are tried, and damping up to half of critical."""
        return [(0.5 * shape[0], 2.0 * shape[0]), (0.0, 3.0 * shape[1])]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Columns of a link that its motor's recorded motion drives by the spring."""
        (j,) = place.joints
        if motion.body is None:
            return {}
        stiffness, give = shape
        inertia = _inertia(motion, j)
        lag = given_way(motion.load(j), inertia, motion.period, stiffness, give * stiffness)
        return deflected(motion, j, lag)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Stiffness and damping."""
        return {"stiffness": shape[0], "damping": shape[1] * shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """All of the simulated spring."""
        stiffness = values["stiffness"]
        return (stiffness, values["damping"] / stiffness), np.ones(1)

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """So compliant a spring [rad/(N m)]."""
        return (1.0 / amount, shape[1]), np.ones(1)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        stiffness, damping = site["stiffness"], site.get("damping")
        return site.each(lambda j: GearPlay(joint=j, stiffness=stiffness, damping=damping))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} gives under load: a spring of {values['stiffness']:.3g} N m/rad lies between"
            " its motor and its link."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"changing load of {where}"


def _inertia(motion: Motion, j: int) -> FloatArray:
    """Inertia of what joint j moves, about its axis, without its known rotor, (T,)."""
    rotor = 0.0 if motion.body is None else float(motion.body.rotor[j])
    return np.maximum(motion.mass_matrix[:, j, j] - rotor, _LIGHTEST)
