"""What an effect is drawn for: a machine, its motions, a place, a size."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import Effect, Gate
from bench.sim2real.concealed.equipment import Controller, Sensors
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.sizing import multiple, sized


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Everything known before the simulation."""

    ref: Reference
    control: Controller
    sensors: Sensors
    rng: np.random.Generator
    places: tuple[int, ...]  # joints (or links) to choose from, in random order
    gate: Gate
    size: float  # wanted multiple of the noise floor
    torque_logged: bool
    corner: str  # "" or what corner the effect hides in

    def sized(self, effect: Effect) -> Effect:
        """The effect at the wanted size."""
        return sized(effect, self.ref, self.sensors, self.size)

    def somewhere(
        self, make: Callable[[int], Effect], places: Iterable[int] | None = None
    ) -> Effect:
        """At the first place where the size is plausible, else where it is largest."""
        best, most = None, -1.0
        for place in self.places if places is None else places:
            effect = self.sized(make(place))
            reached = multiple(effect, self.ref, self.sensors)
            if 0.8 * self.size <= reached <= 1.5 * self.size:
                return effect
            if reached > most:
                best, most = effect, reached
        return best

    def load(self) -> Array:
        """Torque (T, n) that the gears hand on along the commanded motions."""
        return self.ref.tau - self.ref.armature * self.ref.ddq

    def loaded(self) -> list[int]:
        """The places whose changing load is well above the noise, next to the best."""
        share = np.std(self.load(), axis=0) / self.sensors.tau_noise
        return [j for j in self.places if share[j] > 0.3 * np.max(share[list(self.places)])]

    def uniform(self, low: float, high: float) -> float:
        """Four digits."""
        return float(f"{self.rng.uniform(low, high):.4g}")

    def sign(self) -> float:
        """Either."""
        return float(self.rng.choice([-1.0, 1.0]))

    def stick(self, joint: int) -> dict[str, object]:
        """Place and least inertia of a dry friction."""
        return {
            "joint": joint,
            "gate": self.gate_at(joint),
            "inertia": float(0.8 * self.ref.lightest[joint]),
        }

    def gate_at(self, joint: int) -> Gate:
        """The scene's window; one of position is laid where the joint often is."""
        if self.gate.kind != "position":
            return self.gate
        q = self.ref.q[:, joint]
        start = self.gate.low  # as a quantile
        low, high = np.quantile(q, [start, min(start + 0.25, 1.0)])
        high = max(high, low + 0.15)
        return replace(self.gate, low=float(np.round(low, 3)), high=float(np.round(high, 3)))

    def without_gate(self) -> Scene:
        """For effects that act everywhere."""
        return replace(self, gate=Gate())
