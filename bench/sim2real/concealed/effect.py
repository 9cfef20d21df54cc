"""What something concealed may change: the body, the drive, the channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.sim2real.concealed.arm import Arm, Array, Machine

if TYPE_CHECKING:
    from bench.sim2real.concealed.reference import Reference
    from bench.sim2real.concealed.world import Run

StepLaw = Callable[[], None]  # adds to run.applied before a physics step
Drive = Callable[[Array], Array]  # torques exerted for torques commanded, once per physics step


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

    def parameters(self) -> dict[str, float]:
        """Parameters as the catalogue names them."""
        return {}

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
        """Rows (T,) of the commanded motions in which it can be seen, beside its gate."""
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
        """From commanded to exerted torque."""
        return None

    def change_channels(self, channels: dict[str, Array], run: Run) -> None:
        """What the logger writes, in place, before noise."""

    def change_noise(self, noise: dict[str, Array]) -> None:
        """Standard deviations of the channels, in place."""


def one_column(ref: Reference, joint: int, values: Array) -> Array:
    """A torque of one joint among zeros."""
    result = np.zeros_like(ref.q)
    result[:, joint] = values
    return result
