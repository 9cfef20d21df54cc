"""Friction: elastoplastic stick with whatever bounds the law gives, and what MuJoCo has itself."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.sim2real.concealed.effect import Effect, Scene, StepLaw, effect, joint_law, one_column
from bench.sim2real.concealed.mjcf import Machine
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run
from bench.sim2real.frame.arm import Arm, Array

Levels = tuple[float, float]  # backwards, forwards [N m]
Yields = Callable[[float, float, float], Levels]  # of position, speed, time
_REST = 0.01  # speed at which a direction has most of its sign [rad/s]


def elastoplastic(run: Run, joint: int, yields: Yields, inertia: float) -> StepLaw:
    """A very stiff spring that yields at the bounds: sticks exactly, slides at the level.

    The stiffness is a quarter of what the step would bear for the joint's least inertia.
    """
    stiffness = 0.25 * inertia / TIMESTEP**2
    damping = 0.7 * math.sqrt(stiffness * inertia)
    force = 0.0

    def torque(q: float, speed: float, time: float) -> float:
        nonlocal force
        backwards, forwards = yields(q, speed, time)
        force += stiffness * speed * TIMESTEP
        if -backwards <= force <= forwards:
            return min(max(force + damping * speed, -backwards), forwards)
        force = forwards if force > forwards else -backwards
        return force

    return joint_law(run, joint, torque)


@dataclass(frozen=True, slots=True, kw_only=True)
class Friction(Effect):
    """A law by levels; `inertia` is the least the joint ever moves, for the stick's stiffness."""

    inertia: float = 0.1

    effort_share = 0.15

    def level(self, position: Any, speed: Any, time: Any) -> Any:
        """Friction at |speed|, for arrays."""
        raise NotImplementedError

    def yields(self, q: float, v: float, t: float) -> Levels:
        """Between which the joint sticks."""
        raise NotImplementedError

    def residual(self, ref: Reference) -> Array:
        q, v = ref.q[:, self.joint], ref.dq[:, self.joint]
        level = self.level(q, v, ref.time) * self.gate.weight(q, ref.time)
        return one_column(ref, self.joint, level * np.tanh(v / _REST))

    def step_law(self, run: Run) -> StepLaw | None:
        return elastoplastic(run, self.joint, self.yields, self.inertia)


@effect("coulomb_friction", "size", names={"level": "size"})
class Coulomb(Friction):
    """Constant against the motion, by MuJoCo's frictionloss or by the elastoplastic stick."""

    size: float = 1.0
    native: bool = False

    def level(self, position: Any, speed: Any, time: Any) -> Any:
        return self.size

    def yields(self, q: float, v: float, t: float) -> Levels:
        level = self.size * self.gate.weight_of(q, t)
        return level, level

    @property
    def _by_mujoco(self) -> bool:
        return self.native and self.gate.kind == "everywhere"

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        if self._by_mujoco:
            machine.frictionloss[self.joint] += self.size

    def step_law(self, run: Run) -> StepLaw | None:
        return None if self._by_mujoco else Friction.step_law(self, run)


@effect("viscous_friction", "coefficient", effort_share=0.2)
class Viscous(Effect):
    """Against the motion in proportion to speed: MuJoCo's own damping but for a window's."""

    coefficient: float = 1.0

    def residual(self, ref: Reference) -> Array:
        j = self.joint
        weight = self.gate.weight(ref.q[:, j], ref.time)
        return one_column(ref, j, self.coefficient * weight * ref.dq[:, j])

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        if self.gate.kind == "everywhere":
            machine.damping[self.joint] += self.coefficient

    def step_law(self, run: Run) -> StepLaw | None:
        if self.gate.kind == "everywhere":
            return None
        c, weight = self.coefficient, self.gate.weight_of
        return joint_law(run, self.joint, lambda q, v, t: c * weight(q, t) * v)


@effect("stribeck_friction", "extra", names=("extra", "speed"))
class Stribeck(Friction):
    """More friction near standstill than in motion; comes together with Coulomb friction."""

    extra: float = 1.0
    speed: float = 0.1
    coulomb_ratio: float = 1.0  # the accompanying Coulomb level over the extra

    def beside(self) -> dict[str, dict[str, float]]:
        return {"coulomb_friction": {"level": self.coulomb_ratio * self.extra}}

    def acts(self, ref: Reference) -> Array:
        speed = np.abs(ref.dq[:, self.joint])
        return (speed > 0.003) & (speed < 1.5 * self.speed)

    def level(self, position: Any, speed: Any, time: Any) -> Any:
        return self.extra * np.exp(-((speed / self.speed) ** 2))

    def yields(self, q: float, v: float, t: float) -> Levels:
        more = self.extra * math.exp(-((v * (1.0 / self.speed)) ** 2)) * self.gate.weight_of(q, t)
        level = self.coulomb_ratio * self.extra + more
        return level, level


@effect("asymmetric_friction", "level_difference", names=("level_difference", "viscous_difference"))
class Asymmetric(Friction):
    """Other friction forwards than backwards, about a Coulomb level and a viscous coefficient."""

    level_difference: float = 1.0
    viscous_share: float = 0.0  # viscous difference = share * level difference [s/rad]
    coulomb_ratio: float = 1.0  # mean level over the difference, at least 0.5
    viscous_ratio: float = 1.0  # mean coefficient over the difference

    @property
    def viscous_difference(self) -> float:
        return self.viscous_share * self.level_difference

    def beside(self) -> dict[str, dict[str, float]]:
        level = {"level": self.coulomb_ratio * self.level_difference}
        slope = self.viscous_ratio * self.viscous_share * self.level_difference
        viscous = {"viscous_friction": {"coefficient": slope}} if slope else {}
        return {"coulomb_friction": level, **viscous}

    def residual(self, ref: Reference) -> Array:
        """The even part."""
        v = ref.dq[:, self.joint]
        moving = np.abs(np.tanh(v / _REST))
        weight = self.gate.weight(ref.q[:, self.joint], ref.time)
        half = 0.5 * self.level_difference * weight
        return one_column(ref, self.joint, half * (moving + self.viscous_share * np.abs(v)))

    def yields(self, q: float, v: float, t: float) -> Levels:
        dl, dv = self.level_difference, self.viscous_difference
        coulomb, viscous = self.coulomb_ratio * dl, self.viscous_ratio * dv
        w, slope = self.gate.weight_of(q, t), abs(v)
        return (
            max(coulomb + w * -0.5 * dl + (viscous - w * 0.5 * dv) * slope, 0.0),
            max(coulomb + w * 0.5 * dl + (viscous + w * 0.5 * dv) * slope, 0.0),
        )


@effect("load_dependent_friction", "coefficient", bounds=(0.02, 0.4), effort_share=np.inf)
class LoadDependent(Friction):
    """The level is a share of the torque that the gear hands on."""

    coefficient: float = 0.1
    armature: float = 0.0

    def residual(self, ref: Reference) -> Array:
        j = self.joint
        load = ref.tau[:, j] - self.armature * ref.ddq[:, j]
        weight = self.gate.weight(ref.q[:, j], ref.time)
        level = self.coefficient * weight * np.abs(load)
        return one_column(ref, j, level * np.tanh(ref.dq[:, j] / _REST))

    def step_law(self, run: Run) -> StepLaw | None:
        """The load is what the last step handed on, smoothed over 2 ms."""
        j, dof, armature = self.joint, run.world.dof(self.joint), self.armature
        c, weight, blend = self.coefficient, self.gate.weight_of, TIMESTEP / 2e-3
        applied, qacc = run.applied, run.qacc
        load = float(run.world.believed.gravity(run.motion.q[0])[j])
        before = load

        def yields(q: float, v: float, t: float) -> Levels:
            nonlocal load
            load += blend * (before - armature * float(qacc[dof]) - load)
            level = c * abs(load) * weight(q, t)
            return level, level

        stick = elastoplastic(run, j, yields, self.inertia)

        def law() -> None:
            nonlocal before
            stick()
            before = float(applied[dof])

        return law


@effect("presliding_hysteresis", "size", names={"level": "size", "displacement": "displacement"})
class Dahl(Friction):
    """Friction that builds up over a way after each reversal."""

    size: float = 1.0
    displacement: float = 0.02

    def level(self, position: Any, speed: Any, time: Any) -> Any:
        """Roughly: once built up."""
        return self.size

    def step_law(self, run: Run) -> StepLaw | None:
        """The exact solution over a step of constant speed."""
        L, rate = self.size, TIMESTEP / self.displacement
        weight, z = self.gate.weight_of, 0.0

        def torque(q: float, v: float, t: float) -> float:
            nonlocal z
            end = 1.0 if v > 0.0 else -1.0
            z = end + (z - end) * math.exp(-abs(v) * rate)
            return L * z * weight(q, t)

        return joint_law(run, self.joint, torque)


@effect("friction_drift", "extra", names=("extra", "time_constant"))
class Warming(Friction):
    """Extra friction that goes as the joint warms up, over a Coulomb level that stays."""

    extra: float = 1.0
    time_constant: float = 8.0
    coulomb_ratio: float = 1.0  # the level that stays over the extra

    def beside(self) -> dict[str, dict[str, float]]:
        return {"coulomb_friction": {"level": self.coulomb_ratio * self.extra}}

    def level(self, position: Any, speed: Any, time: Any) -> Any:
        return self.extra * np.exp(-time / self.time_constant)

    def yields(self, q: float, v: float, t: float) -> Levels:
        cold = self.extra * math.exp(-t * (1.0 / self.time_constant))
        level = self.coulomb_ratio * self.extra + cold
        return level, level


def viscous(scene: Scene) -> Effect:
    """In proportion to speed."""
    return scene.somewhere(lambda j: Viscous(joint=j, gate=scene.gate_at(j)))


def coulomb(scene: Scene) -> Effect:
    """Half of them by MuJoCo's own dry friction."""
    native = bool(scene.rng.random() < 0.5)
    return scene.somewhere(lambda j: Coulomb(**scene.stick(j), native=native))


def stribeck(scene: Scene) -> Effect:
    """Stribeck friction together with a Coulomb level about as large."""
    speed, ratio = scene.uniform(0.05, 0.25), scene.uniform(0.6, 1.6)
    return scene.somewhere(lambda j: Stribeck(**scene.stick(j), speed=speed, coulomb_ratio=ratio))


def asymmetric(scene: Scene) -> Effect:
    """About a mean friction that leaves both directions positive."""
    share = 0.0 if scene.rng.random() < 0.4 else scene.uniform(0.1, 0.6)
    ratio, slope = scene.uniform(0.6, 1.5), scene.uniform(0.6, 1.5)
    figures = {"viscous_share": share, "coulomb_ratio": ratio, "viscous_ratio": slope}
    return scene.somewhere(lambda j: Asymmetric(**scene.stick(j), **figures))


def load_dependent(scene: Scene) -> Effect:
    """Load-dependent friction at a joint that carries load."""
    rotors = scene.ref.armature
    return scene.somewhere(
        lambda j: LoadDependent(**scene.stick(j), armature=float(rotors[j])), scene.loaded()
    )


def presliding(scene: Scene) -> Effect:
    """Builds up over half a degree to four degrees."""
    way = scene.uniform(0.01, 0.07)
    return scene.somewhere(lambda j: Dahl(**scene.stick(j), displacement=way))


def drift(scene: Scene) -> Effect:
    """Warms up within a recording."""
    constant, ratio = scene.uniform(4.0, 12.0), scene.uniform(0.5, 1.5)
    figures = {"time_constant": constant, "coulomb_ratio": ratio}
    return scene.somewhere(lambda j: Warming(**scene.stick(j), **figures))
