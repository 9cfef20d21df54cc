"""Friction: elastoplastic stick with whatever bounds the law gives, and what MuJoCo has itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Arm, Array, Machine
from bench.sim2real.concealed.effect import Effect, StepLaw, one_column
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run

Bounds = Callable[[float, float, float], tuple[float, float]]  # (q, v, t) -> backwards, forwards


def elastoplastic(run: Run, joint: int, bounds: Bounds, inertia: float) -> StepLaw:
    """A very stiff spring that yields at the bounds: sticks exactly, slides at the level.

    The stiffness is a quarter of what the step would bear for the joint's least inertia.
    """
    dof = run.world.dof(joint)
    stiffness = 0.25 * inertia / TIMESTEP**2
    damping = 0.7 * math.sqrt(stiffness * inertia)
    qpos, qvel, applied, data = run.qpos, run.qvel, run.applied, run.data
    force = 0.0

    def law() -> None:
        nonlocal force
        speed = float(qvel[dof])
        backwards, forwards = bounds(float(qpos[dof]), speed, data.time)
        force += stiffness * speed * TIMESTEP
        if force > forwards:
            force = forwards
            applied[dof] -= force
        elif force < -backwards:
            force = -backwards
            applied[dof] -= force
        else:
            total = force + damping * speed
            applied[dof] -= min(max(total, -backwards), forwards)

    return law


@dataclass(frozen=True, slots=True, kw_only=True)
class Friction(Effect):
    """A law by bounds; `inertia` is the least the joint ever moves, for the stick's stiffness."""

    inertia: float = 0.1

    effort_share = 0.15

    def level(self, position, speed, time):
        """Friction at |speed|, for arrays."""
        raise NotImplementedError

    def residual(self, ref: Reference) -> Array:
        """Level against the motion."""
        j = self.joint
        level = self.level(ref.q[:, j], ref.dq[:, j], ref.time)
        level = level * self.gate.weight(ref.q[:, j], ref.time)
        return one_column(ref, j, level * np.tanh(ref.dq[:, j] / 0.01))


@dataclass(frozen=True, slots=True, kw_only=True)
class Coulomb(Friction):
    """Constant against the motion, by MuJoCo's frictionloss or by the elastoplastic stick."""

    size: float = 1.0
    native: bool = False

    id = "coulomb_friction"
    amplitude = "size"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"level": self.size}

    def level(self, position, speed, time):
        """The same at all speeds."""
        return self.size

    @property
    def _by_mujoco(self) -> bool:
        return self.native and self.gate.kind == "everywhere"

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """MuJoCo's own dry friction."""
        if self._by_mujoco:
            machine.frictionloss[self.joint] += self.size

    def step_law(self, run: Run) -> StepLaw | None:
        """The stick."""
        if self._by_mujoco:
            return None
        size, weight = self.size, self.gate.weight_of

        def bounds(q: float, v: float, t: float) -> tuple[float, float]:
            level = size * weight(q, t)
            return level, level

        return elastoplastic(run, self.joint, bounds, self.inertia)


@dataclass(frozen=True, slots=True, kw_only=True)
class Viscous(Effect):
    """Against the motion in proportion to speed."""

    coefficient: float = 1.0

    id = "viscous_friction"
    amplitude = "coefficient"
    effort_share = 0.2

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"coefficient": self.coefficient}

    def residual(self, ref: Reference) -> Array:
        """In proportion to speed."""
        j = self.joint
        weight = self.gate.weight(ref.q[:, j], ref.time)
        return one_column(ref, j, self.coefficient * weight * ref.dq[:, j])

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """MuJoCo's own damping."""
        if self.gate.kind == "everywhere":
            machine.damping[self.joint] += self.coefficient

    def step_law(self, run: Run) -> StepLaw | None:
        """Damping inside a window."""
        if self.gate.kind == "everywhere":
            return None
        dof, c, weight = run.world.dof(self.joint), self.coefficient, self.gate.weight_of
        qpos, qvel, applied, data = run.qpos, run.qvel, run.applied, run.data

        def law() -> None:
            applied[dof] -= c * weight(float(qpos[dof]), data.time) * qvel[dof]

        return law


@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(Friction):
    """More friction near standstill than in motion; comes with Coulomb friction beside it."""

    extra: float = 1.0
    speed: float = 0.1
    coulomb_ratio: float = 1.0  # the Coulomb level beside it over the extra

    id = "stribeck_friction"
    amplitude = "extra"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"extra": self.extra, "speed": self.speed}

    def beside(self) -> dict[str, dict[str, float]]:
        """The Coulomb friction that this law's stick carries too."""
        return {"coulomb_friction": {"level": self.coulomb_ratio * self.extra}}

    def acts(self, ref: Reference) -> Array:
        """Slow motion."""
        speed = np.abs(ref.dq[:, self.joint])
        return (speed > 0.003) & (speed < 1.5 * self.speed)

    def level(self, position, speed, time):
        """Falls with speed."""
        return self.extra * np.exp(-((speed / self.speed) ** 2))

    def step_law(self, run: Run) -> StepLaw | None:
        """One stick for both."""
        extra, invers, weight = self.extra, 1.0 / self.speed, self.gate.weight_of
        coulomb = self.coulomb_ratio * extra

        def bounds(q: float, v: float, t: float) -> tuple[float, float]:
            level = coulomb + extra * math.exp(-((v * invers) ** 2)) * weight(q, t)
            return level, level

        return elastoplastic(run, self.joint, bounds, self.inertia)
