"""Drives: gain, offset, saturation, ripple; and what pulls at a joint."""

import math

import numpy as np

from bench.sim2real.concealed.effect import (
    Drive,
    Effect,
    Scene,
    StepLaw,
    at_joint,
    effect,
    joint_law,
    one_column,
)
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import Run
from bench.sim2real.frame.arm import Array


@effect("torque_gain", "error", names=("gain",), bounds=(0.01, 0.35))
class TorqueGain(Effect):
    """Reported = gain * true: by the drive's wrong torque constant, or by its sensor alone."""

    error: float = 0.1
    sign: float = 1.0
    by_drive: bool = True  # the drive exerts command / gain and reports the command

    @property
    def gain(self) -> float:
        return 1.0 + self.sign * self.error

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, self.sign * self.error * ref.tau[:, self.joint])

    def drive(self, run: Run) -> Drive | None:
        if not self.by_drive:
            return None
        error, weight, data = self.sign * self.error, self.gate.weight_of, run.data
        return at_joint(self.joint, lambda tau: tau / (1.0 + error * weight(0.0, data.time)))

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        weight = self.gate.weight(0.0, channels["time"])
        channels["tau"][:, self.joint] *= 1.0 + self.sign * self.error * weight


@effect("torque_offset", "size", names=("offset",), effort_share=0.1)
class TorqueOffset(Effect):
    """Reported = true + offset: by the drive's current sensor in its loop, or by a sensor alone."""

    size: float = 0.5
    sign: float = 1.0
    by_drive: bool = True

    @property
    def offset(self) -> float:
        return self.sign * self.size

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, self.offset * self.gate.weight(0.0, ref.time))

    def drive(self, run: Run) -> Drive | None:
        if not self.by_drive:
            return None
        offset, weight, data = self.offset, self.gate.weight_of, run.data
        return at_joint(self.joint, lambda tau: tau - offset * weight(0.0, data.time))

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        weight = self.gate.weight(0.0, channels["time"])
        channels["tau"][:, self.joint] += self.offset * weight


@effect("torque_saturation", "depth", names=("level",), calibrated=True, bounds=(0.02, 0.7))
class Saturation(Effect):
    """The drive gives no more than a level, and reports what it gave."""

    depth: float = 0.2  # of what the motion asks for at most
    peak: float = 1.0  # [N m]
    floor: float = 0.0  # below this the arm would fall [N m]

    @property
    def level(self) -> float:
        """The most it gives [N m]."""
        return float(f"{max(self.peak * (1.0 - self.depth), self.floor):.5g}")

    def residual(self, ref: Reference) -> Array:
        tau = ref.tau[:, self.joint]
        return one_column(ref, self.joint, tau - np.clip(tau, -self.level, self.level))

    def drive(self, run: Run) -> Drive | None:
        level = self.level
        return at_joint(self.joint, lambda tau: min(max(tau, -level), level))


@effect(
    "torque_ripple",
    "size",
    names={"amplitude": "size", "phase": "phase", "harmonic": "harmonic"},
    effort_share=0.1,
)
class Ripple(Effect):
    """A wave over the joint's turn."""

    size: float = 0.5
    phase: float = 0.0
    harmonic: int = 12

    def residual(self, ref: Reference) -> Array:
        q = ref.q[:, self.joint]
        wave = self.size * np.cos(self.harmonic * q + self.phase)
        return one_column(ref, self.joint, wave * self.gate.weight(q, ref.time))

    def step_law(self, run: Run) -> StepLaw | None:
        A, h, phase, weight = self.size, self.harmonic, self.phase, self.gate.weight_of
        return joint_law(
            run, self.joint, lambda q, v, t: A * math.cos(h * q + phase) * weight(q, t)
        )


@effect(
    "position_dependent_spring", "stiffness", names=("stiffness", "onset", "side"), effort_share=0.5
)
class Spring(Effect):
    """A cable or counterbalance that pulls beyond an onset, or everywhere."""

    stiffness: float = 5.0
    onset: float = 0.0
    side: int = 1

    def residual(self, ref: Reference) -> Array:
        way = ref.q[:, self.joint] - self.onset
        if self.side:
            way = np.where(self.side * way > 0.0, way, 0.0)
        return one_column(ref, self.joint, self.stiffness * way)

    def step_law(self, run: Run) -> StepLaw | None:
        k, onset, side = self.stiffness, self.onset, self.side

        def pull(q: float, v: float, t: float) -> float:
            way = q - onset
            return k * way if side == 0 or side * way > 0.0 else 0.0

        return joint_law(run, self.joint, pull)


def by_drive_or_sensor(scene: Scene, make: type[TorqueGain | TorqueOffset]) -> Effect:
    """A wrong torque constant, or a current sensor's zero; half of them of the sensor alone."""
    sign = scene.sign()
    drive = not scene.torque_logged or bool(scene.rng.random() < 0.5)
    return scene.somewhere(lambda j: make(joint=j, gate=scene.gate, sign=sign, by_drive=drive))


def saturation(scene: Scene) -> Effect:
    """Above what holds the arm, below what the motion asks for."""
    tau, ref = np.abs(scene.ref.tau), scene.ref
    some = range(0, len(ref.q), 10)
    holding = np.max([np.abs(ref.dynamics.gravity(ref.q[row])) for row in some], axis=0)
    peak = np.max(tau, axis=0)
    room = sorted(scene.places, key=lambda j: holding[j] / peak[j])[: max(2, ref.arm.n // 2)]
    j = next(j for j in scene.places if j in room)
    return Saturation(joint=j, depth=0.1, peak=float(peak[j]), floor=float(1.15 * holding[j]))


def ripple(scene: Scene) -> Effect:
    """Four to forty waves per turn."""
    harmonic, phase = int(scene.rng.integers(4, 41)), scene.uniform(-np.pi, np.pi)
    return scene.somewhere(
        lambda j: Ripple(joint=j, gate=scene.gate_at(j), harmonic=harmonic, phase=phase)
    )


def spring(scene: Scene) -> Effect:
    """One sided with an onset inside the motion (in a corner: near its end), or everywhere."""
    rng = scene.rng
    side = int(rng.choice([-1, 1])) if scene.corner else int(rng.choice([-1, 0, 1]))
    share = rng.uniform(0.8, 0.93) if scene.corner else rng.uniform(0.45, 0.8)
    quantile = 0.5 if side == 0 else (share if side > 0 else 1.0 - share)

    def make(j: int) -> Effect:
        onset = float(np.round(np.quantile(scene.ref.q[:, j], quantile), 3))
        return Spring(joint=j, side=side, onset=onset)

    return scene.somewhere(make)
