"""Drives: gain, offset, saturation, ripple, delay, lag; and what pulls at a joint."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import Drive, Effect, StepLaw, one_column
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import Run


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueGain(Effect):
    """Reported = gain * true: by the drive's wrong torque constant, or by its sensor alone."""

    error: float = 0.1
    sign: float = 1.0
    by_drive: bool = True  # the drive exerts command / gain and reports the command

    id = "torque_gain"
    amplitude = "error"
    bounds = (0.01, 0.35)

    @property
    def gain(self) -> float:
        """Reported over true."""
        return 1.0 + self.sign * self.error

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"gain": self.gain}

    def residual(self, ref: Reference) -> Array:
        """In proportion to torque."""
        return one_column(ref, self.joint, self.sign * self.error * ref.tau[:, self.joint])

    def _at(self, run: Run, time: Array | float) -> Array | float:
        return 1.0 + self.sign * self.error * self.gate.weight(0.0, time)

    def drive(self, run: Run) -> Drive | None:
        """Less, or more, than commanded."""
        if not self.by_drive:
            return None
        j, error, weight, data = self.joint, self.sign * self.error, self.gate.weight_of, run.data

        def exerted(torque: Array) -> Array:
            torque = torque.copy()
            torque[j] /= 1.0 + error * weight(0.0, data.time)
            return torque

        return exerted

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """What the drive says."""
        channels["tau"][:, self.joint] *= self._at(run, channels["time"])


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueOffset(Effect):
    """Reported = true + offset: by the drive's current sensor in its loop, or by a sensor alone."""

    size: float = 0.5
    sign: float = 1.0
    by_drive: bool = True

    id = "torque_offset"
    amplitude = "size"
    effort_share = 0.1

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"offset": self.sign * self.size}

    def residual(self, ref: Reference) -> Array:
        """Constant."""
        weight = self.gate.weight(0.0, ref.time)
        return one_column(ref, self.joint, self.sign * self.size * weight)

    def drive(self, run: Run) -> Drive | None:
        """Less, or more, than commanded."""
        if not self.by_drive:
            return None
        j, offset, weight, data = self.joint, self.sign * self.size, self.gate.weight_of, run.data

        def exerted(torque: Array) -> Array:
            torque = torque.copy()
            torque[j] -= offset * weight(0.0, data.time)
            return torque

        return exerted

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """What the drive says."""
        weight = self.gate.weight(0.0, channels["time"])
        channels["tau"][:, self.joint] += self.sign * self.size * weight


@dataclass(frozen=True, slots=True, kw_only=True)
class Saturation(Effect):
    """The drive gives no more than a level, and reports what it gave."""

    depth: float = 0.2  # of what the motion asks for at most
    peak: float = 1.0  # [N m]
    floor: float = 0.0  # below this the arm would fall [N m]

    id = "torque_saturation"
    amplitude = "depth"
    calibrated = True
    bounds = (0.02, 0.7)

    @property
    def level(self) -> float:
        """The most it gives [N m]."""
        return float(f"{max(self.peak * (1.0 - self.depth), self.floor):.5g}")

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"level": self.level}

    def residual(self, ref: Reference) -> Array:
        """What is cut off."""
        tau = ref.tau[:, self.joint]
        return one_column(ref, self.joint, tau - np.clip(tau, -self.level, self.level))

    def drive(self, run: Run) -> Drive | None:
        """Clipped."""
        j, level = self.joint, self.level

        def exerted(torque: Array) -> Array:
            if -level <= torque[j] <= level:
                return torque
            torque = torque.copy()
            torque[j] = level if torque[j] > 0.0 else -level
            return torque

        return exerted


@dataclass(frozen=True, slots=True, kw_only=True)
class Ripple(Effect):
    """A wave over the joint's turn."""

    size: float = 0.5
    phase: float = 0.0
    harmonic: int = 12

    id = "torque_ripple"
    amplitude = "size"
    effort_share = 0.1

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"amplitude": self.size, "phase": self.phase, "harmonic": float(self.harmonic)}

    def residual(self, ref: Reference) -> Array:
        """A cosine of position."""
        q = ref.q[:, self.joint]
        wave = self.size * np.cos(self.harmonic * q + self.phase)
        return one_column(ref, self.joint, wave * self.gate.weight(q, ref.time))

    def step_law(self, run: Run) -> StepLaw | None:
        """The same on the machine."""
        dof, A, h, phase = run.world.dof(self.joint), self.size, self.harmonic, self.phase
        qpos, applied, data, weight = run.qpos, run.applied, run.data, self.gate.weight_of

        def law() -> None:
            q = float(qpos[dof])
            applied[dof] -= A * math.cos(h * q + phase) * weight(q, data.time)

        return law


@dataclass(frozen=True, slots=True, kw_only=True)
class Spring(Effect):
    """A cable or counterbalance that pulls beyond an onset, or everywhere."""

    stiffness: float = 5.0
    onset: float = 0.0
    side: int = 1

    id = "position_dependent_spring"
    amplitude = "stiffness"
    effort_share = 0.5

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"stiffness": self.stiffness, "onset": self.onset, "side": float(self.side)}

    def residual(self, ref: Reference) -> Array:
        """In proportion to the way beyond the onset."""
        way = ref.q[:, self.joint] - self.onset
        if self.side:
            way = np.where(self.side * way > 0.0, way, 0.0)
        return one_column(ref, self.joint, self.stiffness * way)

    def step_law(self, run: Run) -> StepLaw | None:
        """The same on the machine."""
        dof, k, onset, side = run.world.dof(self.joint), self.stiffness, self.onset, self.side
        qpos, applied = run.qpos, run.applied

        def law() -> None:
            way = float(qpos[dof]) - onset
            if side == 0 or side * way > 0.0:
                applied[dof] -= k * way

        return law
