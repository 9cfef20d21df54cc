"""What is on top of an ordinary machine, and what a fault is drawn for."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bench.sim2real.frame.arm import Arm
from bench.sim2real.machines.draw import Machine, path_torque
from bench.sim2real.machines.figures import Array, Figures

Log = dict[str, Array]  # channels (T, n) and time (T,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One fault; each part changes what it is about and leaves the rest."""

    kind: str = ""  # as kinds.py has it
    effect: str = ""  # the usual name, or "outside"
    joints: tuple[int, ...] = ()
    links: tuple[int, ...] = ()
    recordings: tuple[int, ...] = ()  # where it acts, if not in all
    window: tuple[float, float] | None = None  # [s]
    parameters: dict[str, float] = field(default_factory=dict)
    figures: Callable[[Figures], Figures] | None = None
    may_begin: bool = False  # whether it may begin in the middle of a recording
    arm: Callable[[Arm], Arm] | None = None
    braked: Callable[[int, int, np.random.Generator], Array] | None = None  # ticks, joints
    push: Callable[[int, int, np.random.Generator], Array] | None = None  # recording, ticks
    log: Callable[[Log, np.random.Generator], None] | None = None

    def truth(self, begins: tuple[int, float] | None) -> dict[str, Any]:
        return {
            "kind": self.kind,
            "effect": self.effect,
            "joints": [f"joint{j + 1}" for j in self.joints],
            "links": [f"link{k + 1}" for k in self.links],
            "recordings": [f"rec{r + 1}.csv" for r in self.recordings],
            "window": self.window and list(self.window),
            "begins": begins and [f"rec{begins[0] + 1}.csv", begins[1]],
            "parameters": self.parameters,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """A machine, its commanded paths every 20 ms, and random numbers."""

    machine: Machine
    q: Array  # (K, n)
    dq: Array
    ddq: Array
    tau: Array  # of the rigid bodies and rotors along it
    recordings: int
    duration: float  # of the shortest [s]
    rng: np.random.Generator
    severity: float = 1.0  # of sizes that would not be seen otherwise

    @property
    def n(self) -> int:
        return self.machine.arm.n

    def uniform(self, low: float, high: float) -> float:
        return float(f"{self.rng.uniform(low, high):.3g}")

    def size(self, low: float, high: float, most: float = np.inf) -> float:
        """A fault's size, as severe as is asked; three digits."""
        return float(f"{min(self.severity * self.rng.uniform(low, high), most):.3g}")

    def reach(self) -> float:
        """Distance from the base to the tool, roughly [m]."""
        ways = [np.linalg.norm(j.T_parent_joint[:3, 3]) for j in self.machine.arm.joints]
        return 0.2 + float(np.sum(ways))

    def sign(self) -> float:
        return float(self.rng.choice([-1.0, 1.0]))

    def joint(self) -> int:
        return int(self.rng.integers(self.n))

    def rated(self, j: int, low: float, high: float) -> float:
        """A torque as a share of a joint's rated one [N m]."""
        share = min(self.severity * self.rng.uniform(low, high), 0.8)
        return float(f"{self.machine.rated[j] * share:.3g}")

    def quantile(self, values: Array, low: float, high: float) -> float:
        """Where a limit is met in so many cases, more often the severer; three digits."""
        share = self.severity * (1.0 - self.rng.uniform(low, high))
        return float(f"{np.quantile(np.abs(values), max(1.0 - share, 0.5)):.3g}")

    def loaded(self) -> int:
        """A joint whose load varies by a tenth of what it is rated for, or the most of all."""
        share = np.std(self.tau, axis=0) / self.machine.rated
        good = [j for j in range(self.n) if share[j] > 0.1]
        return int(self.rng.choice(good)) if good else int(np.argmax(share))

    def change(self, other: Callable[[Arm], Arm]) -> float:
        """How much another arm changes the torques: the most of all joints, of the rated ones."""
        changed = path_torque(self.machine, self.q, self.dq, self.ddq, other(self.machine.arm))
        return float(np.max(np.std(changed - self.tau, axis=0) / self.machine.rated))
