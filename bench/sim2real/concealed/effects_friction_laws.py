"""Friction that depends on direction, load, way or time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import StepLaw, one_column
from bench.sim2real.concealed.effects_friction import Friction, elastoplastic
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run


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
