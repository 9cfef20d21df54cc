"""A spring between motor and link."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..motion.motion import Motion
from ..motion.place import Columns, Place, Shape
from ..motion.signals import lagged
from ..simulation.parts import GearPlay, Part
from ..study.recording import FloatArray
from .effect import Effect, Example, Parameter, on_torque_and_tip, tip_turned
from .site import Site


def deflected(motion: Motion, j: int, deflection: FloatArray) -> Columns:
    """What a link that lags its motor by `deflection` (T,) changes in torques and tip."""
    change = motion.by_deflection(deflection, j)
    return on_torque_and_tip(motion, change, tip_turned(motion, j, -deflection))


class JointElasticity(Effect):
    """The link lags its motor by tau_load / k; the encoder is on the motor."""

    id = "joint_elasticity"
    family = "transmission"
    on = "joint"
    equation = "q_link = q - tau_load / k - d (tau_load)'/k^2; two inertias and a spring"
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
    shown_poorly = True
    simplified = 0.01  # one stiffness and one damping, and the rotor where it is believed
    simulated_rivals = ("backlash",)
    complexity = 3

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Damping over stiffness: the time the spring takes to give [s]."""
        return [(0.0,), (0.005,), (0.015,)]

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Up to a sluggish spring."""
        return [(0.0, 0.05)]

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Of a deflection by the load's torque, per compliance."""
        (j,) = place.joints
        load = motion.transmitted(j)
        if load is None:
            return {}
        if shape[0] > 1e-4:
            load = lagged(load, shape[0], motion.period)
        return deflected(motion, j, load)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Compliance is positive."""
        return np.full(1, 1e-7), np.full(1, 0.1)

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """Stiffness and damping."""
        stiffness = 1.0 / max(float(beta[0]), 1e-12)
        return {"stiffness": stiffness, "damping": shape[0] * stiffness}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The compliance, and damping over stiffness."""
        stiffness = values["stiffness"]
        return (values["damping"] / stiffness,), np.array([1.0 / stiffness])

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        stiffness, damping = site["stiffness"], site.get("damping")
        return site.each(lambda j: GearPlay(joint=j, stiffness=stiffness, damping=damping))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """In words."""
        return (
            f"{where} gives under load: a spring of {values['stiffness']:.3g} N m/rad lies between"
            " its motor and its link."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"changing load of {where}"
