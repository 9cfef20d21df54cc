"""What something concealed may change, and what it is drawn for: a machine, a place, a size."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol, dataclass_transform

import numpy as np

from bench.sim2real.concealed.equipment import Controller, Sensors
from bench.sim2real.concealed.mjcf import Machine
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.frame.arm import Arm, Array
from bench.sim2real.frame.motion import Motion

StepLaw = Callable[[], None]  # adds to run.applied before a physics step
Drive = Callable[[Array], Array]  # torques exerted for torques commanded, once per physics step


class Run(Protocol):
    """One recording's simulation, as far as effects touch it; `world.Run` is the whole."""

    world: Any  # the machine: believed, dof(joint)
    motion: Motion
    recording: int
    model: Any  # MuJoCo's
    data: Any
    qpos: Array
    qvel: Array
    qacc: Array
    applied: Array  # torques besides the motors', (nv,) [N m]
    motor: Any  # MuJoCo's indices of the motors


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """Where an effect acts: everywhere, or in a window of one joint's position or of time."""

    kind: str = "everywhere"  # everywhere | position | time
    low: float = -np.inf
    high: float = np.inf
    edge: float = 0.05  # [rad] or [s]
    recordings: tuple[int, ...] | None = None  # None: all

    def weight(self, position: Any, time: Any) -> Any:
        """How much acts at a position and time, in [0, 1]; arrays or floats."""
        if self.kind == "everywhere":
            return 1.0
        x = position if self.kind == "position" else time
        return np.clip(np.minimum(x - self.low, self.high - x) / self.edge, 0.0, 1.0)

    def weight_of(self, position: float, time: float) -> float:
        """The same for floats, quickly."""
        if self.kind == "everywhere":
            return 1.0
        x = position if self.kind == "position" else time
        inside = min(x - self.low, self.high - x) / self.edge
        return 0.0 if inside <= 0.0 else (1.0 if inside >= 1.0 else inside)


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One thing the believed model lacks; subclasses override what they touch."""

    joint: int | None = None
    gate: Gate = field(default_factory=Gate)

    id = ""
    amplitude = ""  # the field that is scaled to reach a size
    bounds = (0.0, np.inf)  # of the amplitude: what is physically plausible
    effort_share = np.inf  # of the drive's effort that the amplitude may reach
    calibrated = False  # its size is only known after a simulation
    channel = "tau"  # whose residual it makes
    names: ClassVar[Mapping[str, str]] = {}  # of parameters, and their fields here

    def parameters(self) -> dict[str, float]:
        """Parameters as the catalogue names them."""
        return {name: float(getattr(self, field)) for name, field in self.names.items()}

    def beside(self) -> dict[str, dict[str, float]]:
        """Other effects of the catalogue that come with it at the same joint."""
        return {}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        """The joints it is placed at."""
        return () if self.joint is None else (self.joint,)

    def links(self, ref: Reference) -> tuple[int, ...]:
        """The links it is placed at."""
        return ()

    def residual(self, ref: Reference) -> Array:
        """Torque (T, n) that the believed model misses along the commanded motions, roughly."""
        return np.zeros_like(ref.q)

    def limits(self, ref: Reference) -> tuple[float, float]:
        """What is physically plausible of the amplitude on this arm."""
        low, high = self.bounds
        if self.joint is not None and np.isfinite(self.effort_share):
            high = min(high, self.effort_share * ref.arm.joints[self.joint].effort)
        return low, high

    def acts(self, ref: Reference) -> Array:
        """Rows (T,) of the commanded motions in which it can be seen, besides its gate."""
        return np.ones(len(ref.time), bool)

    def scaled(self, value: float) -> Effect:
        """The effect with another amplitude."""
        return replace(self, **{self.amplitude: value})

    def change_arm(self, arm: Arm) -> Arm:
        """The true chain."""
        return arm

    def change_machine(self, machine: Machine, arm: Arm) -> None:
        """The true rotors, gravity and second hinges."""

    def change_command(self, time: Array, q_des: Array, dq_des: Array) -> tuple[Array, Array]:
        """The commands that reach the controller."""
        return q_des, dq_des

    def step_law(self, run: Run) -> StepLaw | None:
        """Called before each physics step."""
        return None

    def drive(self, run: Run) -> Drive | None:
        """The drive's law from commanded to exerted torque."""
        return None

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """What the logger writes, in place, before noise."""

    def change_noise(self, noise: dict[str, Array]) -> None:
        """Standard deviations of the channels, in place."""


@dataclass_transform(frozen_default=True, kw_only_default=True)
def effect(
    name: str,
    amplitude: str = "",
    *,
    names: Iterable[str] | Mapping[str, str] | None = None,
    **more: object,
) -> Callable[[type], type]:
    """A class of effects, with what else `Effect` says of a class.

    Args:
        name: its id in the catalogue.
        amplitude: the field that is scaled.
        names: the catalogue's of its parameters, which fields have too, or with the fields that
            hold them; without it the amplitude's.
        more: other attributes of `Effect`.
    """
    held = {n: n for n in (filter(None, [amplitude]) if names is None else names)}
    held |= names if isinstance(names, Mapping) else {}

    def made(cls: type) -> type:
        for key, value in {"id": name, "amplitude": amplitude, "names": held, **more}.items():
            setattr(cls, key, value)
        return dataclass(frozen=True, slots=True, kw_only=True)(cls)

    return made


def one_column(ref: Reference, joint: int, values: Array) -> Array:
    """A torque of one joint among zeros."""
    result = np.zeros_like(ref.q)
    result[:, joint] = values
    return result


def joint_law(run: Run, joint: int, torque: Callable[[float, float, float], float]) -> StepLaw:
    """A torque against a joint's motor, by its position, its speed and the time."""
    dof, qpos, qvel = run.world.dof(joint), run.qpos, run.qvel
    applied, data = run.applied, run.data

    def law() -> None:
        applied[dof] -= torque(float(qpos[dof]), float(qvel[dof]), data.time)

    return law


def at_joint(joint: int, change: Callable[[float], float]) -> Drive:
    """A drive that exerts something else than is commanded at one joint."""

    def exerted(torque: Array) -> Array:
        torque = torque.copy()
        torque[joint] = change(torque[joint])
        return torque

    return exerted


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
        """The effect at the wanted size, or as near as is plausible."""
        low, high = effect.limits(self.ref)
        value = getattr(effect, effect.amplitude)
        for _ in range(8):
            now = multiple(effect, self.ref, self.sensors)
            new = float(np.clip(value * self.size / now if now > 0.0 else value * 4.0, low, high))
            effect = effect.scaled(new)
            if abs(new / value - 1.0) < 0.02:
                break
            value = new
        return effect.scaled(float(f"{getattr(effect, effect.amplitude):.5g}"))

    def somewhere(
        self, make: Callable[[int], Effect], places: Iterable[int] | None = None
    ) -> Effect:
        """The effect at the first place where the size is plausible, else where it is largest."""
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
        return float(f"{self.rng.uniform(low, high):.4g}")

    def sign(self) -> float:
        return float(self.rng.choice([-1.0, 1.0]))

    def stick(self, joint: int) -> dict[str, object]:
        """Place and least inertia of a dry friction."""
        inertia = float(0.8 * self.ref.lightest[joint])
        return {"joint": joint, "gate": self.gate_at(joint), "inertia": inertia}

    def gate_at(self, joint: int) -> Gate:
        """The scene's window; one of position is laid where the joint often is."""
        if self.gate.kind != "position":
            return self.gate
        q = self.ref.q[:, joint]
        start = self.gate.low  # as a quantile
        low, high = np.quantile(q, [start, min(start + 0.25, 1.0)])
        high = max(high, low + 0.15)
        return replace(self.gate, low=float(np.round(low, 3)), high=float(np.round(high, 3)))


def multiple(effect: Effect, ref: Reference, sensors: Sensors) -> float:
    """Root mean square of what the model misses where it acts, in the worst joint's noise."""
    position = 0.0 if effect.joint is None else ref.q[:, effect.joint]
    rows = np.broadcast_to(effect.gate.weight(position, ref.time), ref.time.shape) > 0.0
    if effect.gate.recordings is not None:
        rows = rows & np.isin(ref.recording, effect.gate.recordings)
    rows = rows & effect.acts(ref)
    if not rows.any():
        return 0.0
    noise = {"dq": sensors.dq_noise, "q": sensors.q_seen}.get(effect.channel, sensors.tau_noise)
    rms = np.sqrt(np.mean(effect.residual(ref)[rows] ** 2, axis=0))
    result = float(np.max(rms / noise))
    shift = getattr(effect, "tip_shift", None)
    if sensors.tip and shift is not None:
        some = np.arange(0, len(ref.q), 10)
        tip = np.sqrt(np.mean(shift(ref, some) ** 2, axis=0))
        result = max(result, float(np.max(tip / sensors.tip_noise)))
    return result
