"""Play in the gear."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, Shape
from ...simulation import GearPlay, Part
from ..effect import Effect, Example, Parameter
from ..site import Site
from .joint_elasticity import deflected

_GAPS = (0.0006, 0.0012, 0.0024, 0.0036, 0.0052, 0.0076, 0.011, 0.016, 0.024, 0.035, 0.055)
_STEP = 8e-4  # of the simulation [s]
_FLANK = 2 * np.pi * 30.0  # natural frequency of the link on a flank [rad/s]
_DAMPING = 2.0  # ratio: a greased gear does not bounce


def swing(torque: FloatArray, inertia: FloatArray, period: float, gap: FloatArray) -> FloatArray:
    """How far a link lags its motor in a gear with play, (T, k) for k gears at once.

    In the motor's frame the link feels the torque that a rigid gear would transmit, and the flanks:
    I u'' = torque - F(u). Semi-implicit Euler.

    Args:
        torque: (T, k) a rigid gear would transmit [N m].
        inertia: (k,) or (T, k) of the links about their joints [kg m^2].
        period: of the samples [s].
        gap: (k,) whole play [rad].
    """
    steps = max(1, int(np.ceil(period / _STEP)))
    h = period / steps
    half = 0.5 * gap
    rate = torque / inertia
    slope = np.diff(rate, axis=0, append=rate[-1:]) / steps
    u = half * np.sign(rate[0])
    v = np.zeros_like(u)
    lag = np.empty_like(rate)
    for t in range(len(rate)):
        lag[t] = u
        pull = rate[t] + 0.5 * slope[t]
        for _ in range(steps):
            beyond = u - np.minimum(np.maximum(u, -half), half)
            push = _FLANK**2 * beyond + (2.0 * _DAMPING * _FLANK) * v
            push[push * beyond <= 0.0] = 0.0  # a flank pushes, never pulls
            v = v + h * (pull - push)
            u = u + h * v
            pull = pull + slope[t]
    return lag


class Backlash(Effect):
    """A link between two flanks: simulated along the motor's recorded motion."""

    id = "backlash"
    family = "transmission"
    on = "joint"
    equation = "I u'' = tau_rigid - F(u), u = q - q_link; F is zero within gap / 2, stiff beyond"
    parameters = (Parameter("gap", "rad", lower=0.0),)
    confused_with = ("joint_elasticity", "presliding_hysteresis", "coulomb_friction")
    decided_by = "slow motion through the pose where the joint's load changes its sign"
    source = "Nordin and Gutman, Automatica 38(10), 2002"
    example = Example(values={"gap": 0.01}, nothing={"gap": 0.0})
    instead = ("joint_elasticity",)
    simplified = 0.05  # flanks' stiffness and grease are not fitted
    shown_poorly = True
    simulated_rivals = ("joint_elasticity",)
    complexity = 3
    costly = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Gaps from a twentieth of a degree to three degrees [rad]."""
        return [(gap,) for gap in _GAPS]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Bounds of the gap [rad]: the neighbours among those that are tried."""
        return [(0.55 * shape[0], 1.8 * shape[0])]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Columns of a link that swings between its flanks, driven by the recorded motor."""
        (j,) = place.joints
        if motion.body is None:
            return {}
        return deflected(motion, j, _lag(motion, j, shape[0]))

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The coefficient says how much of the simulated play is there: near one."""
        return np.full(1, 0.25), np.full(1, 1.6)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The whole gap."""
        return {"gap": shape[0]}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """All of the simulated play."""
        return (values["gap"],), np.ones(1)

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """So wide a gap."""
        return (amount,), np.ones(1)

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: GearPlay(joint=j, gap=site["gap"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"{where} has play: {np.degrees(values['gap']):.2g} degrees lie between the two flanks"
            " of its gear."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"changes of the sign of the load of {where}"


def _lag(motion: Motion, j: int, gap: float) -> FloatArray:
    """Joint j's lag with this play, (T,), kept with the gaps and joints simulated along."""
    name = f"play {j} {gap:.9g}"
    if name not in motion.cache:
        first = any(math.isclose(gap, each) for each in _GAPS)
        joints = range(motion.n) if first else [j]
        gaps = np.array(_GAPS) if first else gap * 1.06 ** np.arange(-6.0, 7.0)
        pairs = [(i, float(g)) for i in joints for g in gaps]
        load = np.stack([motion.load(i) for i, _ in pairs], axis=1)
        inertia = np.stack([motion.mass_matrix[:, i, i] for i, _ in pairs], axis=1)
        inertia = np.maximum(inertia, 1e-6)
        lags = swing(load, inertia, motion.period, np.array([g for _, g in pairs]))
        for (i, g), lag in zip(pairs, lags.T, strict=True):
            motion.cache.setdefault(f"play {i} {g:.9g}", np.ascontiguousarray(lag))
    return motion.cache[name]
