"""Channels: late, scaled, noisy, or lying outright."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import Effect, one_column
from bench.sim2real.concealed.effects_late import rate
from bench.sim2real.concealed.measure import torque_along
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import Run


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel(Effect):
    """Something about one channel; the machine itself is as believed."""

    of: str = "tau"

    @property
    def channel(self) -> str:
        """The channel it is about."""
        return self.of


@dataclass(frozen=True, slots=True, kw_only=True)
class Skew(Channel):
    """A channel of all joints is logged late."""

    skew: float = 0.01

    id = "timestamp_skew"
    amplitude = "skew"
    bounds = (0.0015, 0.06)

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"skew": self.skew}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        """All."""
        return tuple(range(ref.arm.n))

    def residual(self, ref: Reference) -> Array:
        """In proportion to the channel's rate."""
        if self.channel == "dq":
            return -self.skew * ref.ddq
        return -self.skew * np.column_stack([rate(ref, j) for j in range(ref.arm.n)])

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """Rows of a moment ago."""
        time, values = channels["time"], channels[self.channel]
        for j in range(values.shape[1]):
            values[:, j] = np.interp(time - self.skew, time, values[:, j])


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorGain(Channel):
    """One joint's speed or position is scaled."""

    error: float = 0.1
    sign: float = 1.0

    id = "sensor_gain"
    amplitude = "error"
    bounds = (0.002, 0.35)

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"gain": 1.0 + self.sign * self.error}

    def residual(self, ref: Reference) -> Array:
        """In proportion to the channel."""
        values = {"q": ref.q, "dq": ref.dq, "tau": ref.tau}[self.channel]
        return one_column(ref, self.joint, self.sign * self.error * values[:, self.joint])

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """Scaled."""
        channels[self.channel][:, self.joint] *= 1.0 + self.sign * self.error


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorNoise(Channel):
    """One joint's channel is noisier than the others'."""

    std: float = 0.1

    id = "sensor_noise"
    amplitude = "std"

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"std": self.std}

    def residual(self, ref: Reference) -> Array:
        """As large as its deviation."""
        return one_column(ref, self.joint, np.full(len(ref.time), self.std))

    def change_noise(self, noise: dict[str, Array]) -> None:
        """More."""
        noise[self.channel][self.joint] = self.std


LIES = ("tau_sign", "q_degrees", "tau_rotor", "tau_model", "dq_scaled")


@dataclass(frozen=True, slots=True, kw_only=True)
class Lie(Channel):
    """A channel that is not what its name says."""

    kind: str = "tau_sign"
    factor: float = 1.0

    id = "lying_channel"

    def parameters(self) -> dict[str, float]:
        """Logged over true, where it is a factor."""
        return {} if self.kind == "tau_model" else {"gain": self.factor}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        """One, or all when the model was logged."""
        return tuple(range(ref.arm.n)) if self.kind == "tau_model" else (self.joint,)

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """Scaled; or the controller's own model of the commanded motion."""
        if self.kind == "tau_model":
            channels["tau"][:] = torque_along(run.world.believed, channels["time"], run.motion)
        else:
            channels[self.channel][:, self.joint] *= self.factor
