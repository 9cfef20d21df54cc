"""Torque laws of one joint, in plain floats: they are asked every millisecond."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from ..motion import Gate
from .parts import Law, StatefulLaw

Variable = Literal["time", "position", "speed", "load"]
VARIABLES: tuple[Variable, ...] = ("time", "position", "speed", "load")


class Dahl(StatefulLaw):
    """Friction that begins as a spring: L z with dz/dt = (dq/displacement)(1 - z sign dq)."""

    def __init__(self, level: float, displacement: float) -> None:
        self.level, self.displacement = level, max(displacement, 1e-9)
        self.stiffness = 2.0 * level / self.displacement  # just after a reversal
        self.z = 0.0

    def fresh(self) -> Dahl:
        return type(self)(self.level, self.displacement)

    def __call__(self, t: float, q: float, dq: float, load: float) -> float:
        return self.level * self.z

    def advance(self, q: float, dq: float, dt: float) -> None:
        side = 1.0 if dq > 0 else -1.0
        self.z = side + (self.z - side) * math.exp(-abs(dq) * dt / self.displacement)


class GatedMemory(StatefulLaw):
    """A law with a memory, of which a part is seen."""

    def __init__(self, law: StatefulLaw, gate: Gate) -> None:
        self.law, self.gate, self.stiffness = law, gate, law.stiffness
        self.clock = gate.of == "time"

    def fresh(self) -> GatedMemory:
        return type(self)(self.law.fresh(), self.gate)

    def __call__(self, t: float, q: float, dq: float, load: float) -> float:
        return self.gate.weight_at(t if self.clock else q) * self.law(t, q, dq, load)

    def advance(self, q: float, dq: float, dt: float) -> None:
        self.law.advance(q, dq, dt)


def gated(law: Law, gate: Gate) -> Law:
    """The law within a part of time or of positions."""
    clock, weight = gate.of == "time", gate.weight_at

    def inside(t: float, q: float, dq: float, load: float) -> float:
        share = weight(t if clock else q)
        return share * law(t, q, dq, load) if share else 0.0

    return inside


def constant(value: float) -> Law:
    """The same always."""
    return lambda t, q, dq, load: value


def ripple(amplitude: float, phase: float, harmonic: float) -> Law:
    """A cos(h q + phase)."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return amplitude * math.cos(harmonic * q + phase)

    return law


def spring(stiffness: float, onset: float, side: float) -> Law:
    """Torque k (q - onset), only beyond the onset where `side` is not 0."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        beyond = q - onset
        return stiffness * beyond if side * beyond >= 0 else 0.0

    return law


def level_asymmetry(difference: float) -> Law:
    """Level +-dl/2 with the direction; exact as long as the whole level stays above zero."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return 0.5 * difference if dq > 0 else -0.5 * difference

    return law


def viscous_asymmetry(difference: float) -> Law:
    """Torque dv |dq| / 2."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return 0.5 * difference * abs(dq)

    return law


def stribeck(extra: float, speed: float) -> Law:
    """Level extra exp(-(dq / speed)^2)."""
    speed = max(speed, 1e-9)

    def law(t: float, q: float, dq: float, load: float) -> float:
        return extra * math.exp(-((dq / speed) ** 2))

    return law


def of_load(coefficient: float) -> Law:
    """Level c |load|."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return coefficient * abs(load)

    return law


def of_driven_load(driving: float, driven: float) -> Law:
    """Level by |load|: one share where the motor moves the load, another where that moves it."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return (driving if load * dq > 0.0 else driven) * abs(load)

    return law


def drift(extra: float, time_constant: float) -> Law:
    """Level extra exp(-t / time_constant)."""
    time_constant = max(time_constant, 1e-9)

    def law(t: float, q: float, dq: float, load: float) -> float:
        return extra * math.exp(-t / time_constant)

    return law


def cycle(frequency: float, cosine: float, sine: float) -> Law:
    """Cosine cos(2 pi f t) + sine sin(2 pi f t)."""
    omega = 2.0 * math.pi * frequency

    def law(t: float, q: float, dq: float, load: float) -> float:
        return cosine * math.cos(omega * t) + sine * math.sin(omega * t)

    return law


def of_speed(coefficient: Law) -> Law:
    """Torque c dq, c by another law."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return coefficient(t, q, dq, load) * dq

    return law


def smooth_sign(level: Law, within: float = 0.02) -> Law:
    """Torque level tanh(dq / within)."""

    def law(t: float, q: float, dq: float, load: float) -> float:
        return level(t, q, dq, load) * math.tanh(dq / within)

    return law


def curve(variable: Variable, knots: Sequence[float], values: Sequence[float]) -> Law:
    """Straight lines between points; beyond the outermost knots the outermost values.

    Raises:
        ValueError: knots and values are not as many, none, or the knots do not grow.
    """
    x, y = np.asarray(knots, dtype=float), np.asarray(values, dtype=float)
    if len(x) != len(y) or not len(x) or (np.diff(x) <= 0).any():
        raise ValueError(f"knots must grow and be as many as values, got {len(x)} and {len(y)}")
    which = VARIABLES.index(variable)
    low, high = float(x[0]), float(x[-1])
    # An even table is quicker to look up than uneven knots, and every knot is near one of its own.
    count = min(max(64 * len(x), 2), 4096) if len(x) > 1 else 2
    table: list[float] = np.interp(np.linspace(low, high, count), x, y).tolist()
    rate = (count - 1) / (high - low) if high > low else 0.0

    def law(t: float, q: float, dq: float, load: float) -> float:
        place = ((t, q, dq, load)[which] - low) * rate
        if place <= 0.0:
            return table[0]
        k = int(place)
        if k >= count - 1:
            return table[-1]
        return table[k] + (place - k) * (table[k + 1] - table[k])

    return law
