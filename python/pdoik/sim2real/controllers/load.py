"""What a voltage-driven joint shows of its load: how heavy, how long, or only a ratio of both.

Of a load m at the distance l with a rotor J only (m l^2 + J) / (m l) is seen, the reduced length,
where nothing gives the torque's scale. With the torque per volt and J it is m and l.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..findings import Estimate
from ..motion import STANDARD_GRAVITY, RigidBody
from .voltage import Figure, Motor

_GRID = 24  # positions at which the load's moment is looked for


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """The load of one joint; factors are of the model's."""

    reduced_length: Figure  # of load and rotor together [m]
    own_length: float  # of the model's load without a rotor [m]
    mass: Figure | None = None  # factor
    length: Figure | None = None  # factor

    def estimates(self) -> dict[str, Estimate]:
        """Figures by name."""
        result = {"reduced_length": self.reduced_length.estimate("m")}
        for name in ("mass", "length"):
            factor = getattr(self, name)
            if factor is not None:
                result[f"{name}_factor"] = factor.estimate("-")
        return result


def load_of(body: RigidBody, j: int, motor: Motor, drive_error: float) -> Load | None:
    """The load of the last joint of a chain about a level axis; None of any other.

    Args:
        body: of the model.
        j: the joint.
        motor: its drive.
        drive_error: share by which a torque per volt may differ from what was given.
    """
    if body.axis(j) is None or body.depth[j] != body.depth.max():
        return None
    turn = np.zeros((_GRID, body.n))
    turn[:, j] = np.linspace(0.0, 2.0 * np.pi, _GRID, endpoint=False)
    moment = float(np.abs(body.gravity(turn)[:, j]).max()) / STANDARD_GRAVITY  # m l
    inertia = float(body.mass_diagonal(turn[0])[j] - body.rotor[j])  # m l^2
    if moment <= 0.0 or inertia <= 0.0:
        return None
    a, b, rotor = motor.gravity, motor.inertia, motor.rotor_inertia
    whole = (b.value * inertia + rotor.value) / (a.value * moment)
    spread = np.hypot(b.std * inertia, rotor.std) / (a.value * moment)
    spread = float(np.hypot(spread, whole * a.std / a.value))
    load = Load(reduced_length=Figure(value=whole, std=spread), own_length=inertia / moment)
    if motor.given and motor.given_rotor and b.value > 0.0:
        relative = np.hypot(a.std / a.value, b.std / b.value)
        twice = np.hypot(2.0 * a.std / a.value, b.std / b.value)
        twice = np.hypot(twice, drive_error)  # a length is a ratio, which the scale leaves alone
        return Load(
            reduced_length=load.reduced_length,
            own_length=load.own_length,
            length=Figure(value=b.value / a.value, std=float(b.value / a.value * relative)),
            mass=Figure(value=a.value**2 / b.value, std=float(a.value**2 / b.value * twice)),
        )
    return load


def in_words(joint: str, load: Load, rotor_given: bool, sure: float) -> str:
    """A sentence or two."""
    if load.mass is not None and load.length is not None:
        factors = [
            f"{name} is {factor.value:.3g} ± {1.96 * factor.std:.2g} times the model's"
            for name, factor in (("mass", load.mass), ("length", load.length))
        ]
        said = ", its ".join(factors)
        return f"{joint}: with the drive's parameters in the study, its load's {said}."
    whole, own = load.reduced_length, load.own_length
    said = (
        f"{joint}: whatever the load weighs, load and rotor together swing like a pendulum of"
        f" {whole.value:.4g} ± {1.96 * whole.std:.2g} m; the model's load alone is one of"
        f" {own:.4g} m"
    )
    if own > whole.value + sure * whole.std:
        least = 100.0 * (own / whole.value - 1.0)
        return f"{said}: it is too long by {least:.2g} % at least, since no rotor shortens it."
    if rotor_given:
        return f"{said}."
    return (
        f"{said}, and the rest was attributed to the rotor. A load of another length with another"
        f" rotor moves alike; none longer than {whole.value + 1.96 * whole.std:.3g} m does."
    )
