"""Friction: elastoplastic stick with whatever bounds the law gives, and what MuJoCo has itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from bench.concealed.arm import Arm, Array, Machine
from bench.concealed.effect import Effect, StepLaw, one_column
from bench.concealed.reference import Reference
from bench.concealed.world import TIMESTEP, Run

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Asymmetric(Friction):
    """Other friction forwards than backwards, about a Coulomb level and a viscous coefficient."""

    level_difference: float = 1.0
    viscous_share: float = 0.0  # viscous difference = share * level difference [s/rad]
    coulomb_ratio: float = 1.0  # mean level over the difference, at least 0.5
    viscous_ratio: float = 1.0  # mean coefficient over the difference

    id = "asymmetric_friction"
    amplitude = "level_difference"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {
            "level_difference": self.level_difference,
            "viscous_difference": self.viscous_share * self.level_difference,
        }

    def beside(self) -> dict[str, dict[str, float]]:
        """The mean friction."""
        level = {"level": self.coulomb_ratio * self.level_difference}
        slope = self.viscous_ratio * self.viscous_share * self.level_difference
        viscous = {"viscous_friction": {"coefficient": slope}} if slope else {}
        return {"coulomb_friction": level, **viscous}

    def residual(self, ref: Reference) -> Array:
        """The even part."""
        v = ref.dq[:, self.joint]
        moving = np.abs(np.tanh(v / 0.01))
        weight = self.gate.weight(ref.q[:, self.joint], ref.time)
        half = 0.5 * self.level_difference * weight
        return one_column(ref, self.joint, half * (moving + self.viscous_share * np.abs(v)))

    def step_law(self, run: Run) -> StepLaw | None:
        """Two levels, two slopes."""
        dl, dv = self.level_difference, self.viscous_share * self.level_difference
        coulomb, viscous = self.coulomb_ratio * dl, self.viscous_ratio * dv
        weight = self.gate.weight_of

        def bounds(q: float, v: float, t: float) -> tuple[float, float]:
            w = weight(q, t)
            slope = abs(v)
            return (
                max(coulomb + w * -0.5 * dl + (viscous - w * 0.5 * dv) * slope, 0.0),
                max(coulomb + w * 0.5 * dl + (viscous + w * 0.5 * dv) * slope, 0.0),
            )

        return elastoplastic(run, self.joint, bounds, self.inertia)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadDependent(Friction):
    """The level is a share of the torque that the gear hands on."""

    coefficient: float = 0.1
    armature: float = 0.0

    id = "load_dependent_friction"
    amplitude = "coefficient"
    bounds = (0.02, 0.4)
    effort_share = np.inf

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"coefficient": self.coefficient}

    def residual(self, ref: Reference) -> Array:
        """A share of the load against the motion."""
        j = self.joint
        load = ref.tau[:, j] - self.armature * ref.ddq[:, j]
        weight = self.gate.weight(ref.q[:, j], ref.time)
        level = self.coefficient * weight * np.abs(load)
        return one_column(ref, j, level * np.tanh(ref.dq[:, j] / 0.01))

    def step_law(self, run: Run) -> StepLaw | None:
        """The load is what the last step handed on, smoothed over 2 ms."""
        j, dof, armature = self.joint, run.world.dof(self.joint), self.armature
        c, weight, blend = self.coefficient, self.gate.weight_of, TIMESTEP / 2e-3
        applied, qacc = run.applied, run.qacc
        load = float(run.world.believed.gravity(run.motion.q[0])[j])
        before = load

        def bounds(q: float, v: float, t: float) -> tuple[float, float]:
            nonlocal load
            load += blend * (before - armature * float(qacc[dof]) - load)
            level = c * abs(load) * weight(q, t)
            return level, level

        stick = elastoplastic(run, j, bounds, self.inertia)

        def law() -> None:
            nonlocal before
            stick()
            before = float(applied[dof])

        return law


@dataclass(frozen=True, slots=True, kw_only=True)
class Dahl(Friction):
    """Friction that builds up over a way after each reversal."""

    size: float = 1.0
    displacement: float = 0.02

    id = "presliding_hysteresis"
    amplitude = "size"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"level": self.size, "displacement": self.displacement}

    def level(self, position, speed, time):
        """Roughly: once built up."""
        return self.size

    def step_law(self, run: Run) -> StepLaw | None:
        """The exact solution over a step of constant speed."""
        dof, L, rate = run.world.dof(self.joint), self.size, TIMESTEP / self.displacement
        qpos, qvel, applied, data = run.qpos, run.qvel, run.applied, run.data
        weight, z = self.gate.weight_of, 0.0

        def law() -> None:
            nonlocal z
            v = float(qvel[dof])
            end = 1.0 if v > 0.0 else -1.0
            z = end + (z - end) * math.exp(-abs(v) * rate)
            applied[dof] -= L * z * weight(float(qpos[dof]), data.time)

        return law


@dataclass(frozen=True, slots=True, kw_only=True)
class Warming(Friction):
    """Extra friction that goes as the joint warms up, over a Coulomb level that stays."""

    extra: float = 1.0
    time_constant: float = 8.0
    coulomb_ratio: float = 1.0  # the level that stays over the extra

    id = "friction_drift"
    amplitude = "extra"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"extra": self.extra, "time_constant": self.time_constant}

    def beside(self) -> dict[str, dict[str, float]]:
        """The Coulomb friction that stays."""
        return {"coulomb_friction": {"level": self.coulomb_ratio * self.extra}}

    def level(self, position, speed, time):
        """Falls with time."""
        return self.extra * np.exp(-time / self.time_constant)

    def step_law(self, run: Run) -> StepLaw | None:
        """One stick for both."""
        extra, invers = self.extra, 1.0 / self.time_constant
        coulomb = self.coulomb_ratio * extra

        def bounds(q: float, v: float, t: float) -> tuple[float, float]:
            level = coulomb + extra * math.exp(-t * invers)
            return level, level

        return elastoplastic(run, self.joint, bounds, self.inertia)
