"""Channels: late, scaled, noisy, or lying outright."""

from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.effect import Effect, Scene, effect, one_column
from bench.sim2real.concealed.effects_late import rate
from bench.sim2real.concealed.logger import torque_along
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import Run
from bench.sim2real.frame.arm import Array

LIES = ("tau_sign", "q_degrees", "tau_rotor", "tau_model", "dq_scaled")


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel(Effect):
    """Something about one channel; the machine itself is as believed."""

    of: str = "tau"

    @property
    def channel(self) -> str:
        return self.of


@effect("timestamp_skew", "skew", bounds=(0.0015, 0.06))
class Skew(Channel):
    """A channel of all joints is logged late."""

    skew: float = 0.01

    def joints(self, ref: Reference) -> tuple[int, ...]:
        return tuple(range(ref.arm.n))

    def residual(self, ref: Reference) -> Array:
        if self.channel == "dq":
            return -self.skew * ref.ddq
        return -self.skew * np.column_stack([rate(ref, j) for j in range(ref.arm.n)])

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        time, values = channels["time"], channels[self.channel]
        for j in range(values.shape[1]):
            values[:, j] = np.interp(time - self.skew, time, values[:, j])


@effect("sensor_gain", "error", names=("gain",), bounds=(0.002, 0.35))
class SensorGain(Channel):
    """One joint's speed or position is scaled."""

    error: float = 0.1
    sign: float = 1.0

    @property
    def gain(self) -> float:
        return 1.0 + self.sign * self.error

    def residual(self, ref: Reference) -> Array:
        values = {"q": ref.q, "dq": ref.dq, "tau": ref.tau}[self.channel]
        return one_column(ref, self.joint, self.sign * self.error * values[:, self.joint])

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        channels[self.channel][:, self.joint] *= self.gain


@effect("sensor_noise", "std")
class SensorNoise(Channel):
    """One joint's channel is noisier than the others'."""

    std: float = 0.1

    def residual(self, ref: Reference) -> Array:
        return one_column(ref, self.joint, np.full(len(ref.time), self.std))

    def change_noise(self, noise: dict[str, Array]) -> None:
        noise[self.channel][self.joint] = self.std


@effect("lying_channel")
class Lie(Channel):
    """A channel that is not what its name says: scaled, or the controller's own model."""

    kind: str = "tau_sign"
    factor: float = 1.0

    def parameters(self) -> dict[str, float]:
        """Logged over true, where it is a factor."""
        return {} if self.kind == "tau_model" else {"gain": self.factor}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        return tuple(range(ref.arm.n)) if self.kind == "tau_model" else (self.joint,)

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        if self.kind == "tau_model":
            channels["tau"][:] = torque_along(run.world.believed, channels["time"], run.motion)
        else:
            channels[self.channel][:, self.joint] *= self.factor


def skew(scene: Scene) -> Effect:
    """Torque or speed logged late; speeds never less than some milliseconds when obvious."""
    of = "tau" if scene.torque_logged and scene.rng.random() < 0.5 else "dq"
    return scene.sized(Skew(of=of))


def sensor_gain(scene: Scene) -> Effect:
    """A speed, more rarely a position."""
    of, sign = ("dq" if scene.rng.random() < 0.75 else "q"), scene.sign()
    effect = scene.somewhere(lambda j: SensorGain(joint=j, of=of, sign=sign))
    if scene.size > 5.0:
        low, high = (0.03, 0.2) if of == "dq" else (0.01, 0.08)
        effect = effect.scaled(max(effect.error, scene.uniform(low, high)))
    return effect


def sensor_noise(scene: Scene) -> Effect:
    """Three to twelve times the others'."""
    of = str(scene.rng.choice(["tau", "dq"])) if scene.torque_logged else "dq"
    return scene.sized(SensorNoise(joint=scene.places[0], of=of))


def lie(scene: Scene, kind: str) -> Effect:
    """One joint's channel under a false name; the model logged as torque for all joints."""
    if kind not in LIES:
        raise ValueError(f"kind is {kind!r}, expected one of {', '.join(LIES)}")
    rng, joint = scene.rng, scene.places[0]
    if kind == "tau_model":
        return Lie(kind=kind)
    of, factor = {
        "tau_sign": ("tau", -1.0),
        "q_degrees": ("q", 180.0 / np.pi),
        "tau_rotor": ("tau", 1.0 / float(rng.choice([50, 80, 100, 101, 120, 160]))),
        "dq_scaled": ("dq", float(rng.choice([30.0 / np.pi, 180.0 / np.pi, 100.0]))),
    }[kind]
    if of == "tau":  # at a joint whose torque is more than noise
        tau = np.std(scene.ref.tau, axis=0) / scene.sensors.tau_noise
        joint = next((j for j in scene.places if tau[j] > 10.0), int(np.argmax(tau)))
    return Lie(kind=kind, of=of, factor=factor, joint=joint)
