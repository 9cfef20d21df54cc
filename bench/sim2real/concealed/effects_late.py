"""Commands that act late: transport delay and first order lag."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.effect import Drive, Effect
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run


@dataclass(frozen=True, slots=True, kw_only=True)
class Delay(Effect):
    """Commands act late: positions sent over a bus, or torques inside the drives."""

    delay: float = 0.01
    places: tuple[int, ...] = ()
    of: str = "q_des"  # or tau_cmd
    kp: tuple[float, ...] = ()

    id = "command_delay"
    amplitude = "delay"
    bounds = (0.0015, 0.08)

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"delay": self.delay}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        """All on the bus, or one drive."""
        return self.places

    def residual(self, ref: Reference) -> Array:
        """Of the control law, roughly."""
        result = np.zeros_like(ref.q)
        for j in self.places:
            if self.of == "q_des":
                result[:, j] = self.delay * self.kp[j] * ref.dq[:, j]
            else:
                result[:, j] = self.delay * rate(ref, j)
        return result

    def change_command(self, time: Array, q_des: Array, dq_des: Array) -> tuple[Array, Array]:
        """Positions and speeds of a moment ago."""
        if self.of != "q_des":
            return q_des, dq_des
        q_des, dq_des = q_des.copy(), dq_des.copy()
        for j in self.places:
            q_des[:, j] = np.interp(time - self.delay, time, q_des[:, j])
            dq_des[:, j] = np.interp(time - self.delay, time, dq_des[:, j])
        return q_des, dq_des

    def drive(self, run: Run) -> Drive | None:
        """Torques of a moment ago."""
        if self.of != "tau_cmd":
            return None
        steps, places = max(1, round(self.delay / TIMESTEP)), list(self.places)
        queue: deque[Array] = deque()

        def exerted(torque: Array) -> Array:
            queue.append(torque)
            if len(queue) <= steps:
                return torque
            old = queue.popleft()
            torque = torque.copy()
            torque[places] = old[places]
            return torque

        return exerted


@dataclass(frozen=True, slots=True, kw_only=True)
class Lag(Effect):
    """Torque follows the command with a time constant."""

    time_constant: float = 0.005
    places: tuple[int, ...] = ()
    slowest: float = 0.03  # that the controller bears [s]

    id = "actuator_lag"
    amplitude = "time_constant"

    def limits(self, ref: Reference) -> tuple[float, float]:
        """A millisecond, to what the controller bears."""
        return 0.001, max(0.001, min(self.slowest, 0.04))

    def parameters(self) -> dict[str, float]:
        """As the catalogue names them."""
        return {"time_constant": self.time_constant}

    def joints(self, ref: Reference) -> tuple[int, ...]:
        """All drives, or one."""
        return self.places

    def residual(self, ref: Reference) -> Array:
        """Of the control law, roughly."""
        result = np.zeros_like(ref.q)
        for j in self.places:
            result[:, j] = self.time_constant * rate(ref, j)
        return result

    def drive(self, run: Run) -> Drive | None:
        """First order, exact for a held command."""
        blend, places = 1.0 - math.exp(-TIMESTEP / self.time_constant), list(self.places)
        state: Array | None = None

        def exerted(torque: Array) -> Array:
            nonlocal state
            if state is None:
                state = torque[places].copy()
            state = state + blend * (torque[places] - state)
            torque = torque.copy()
            torque[places] = state
            return torque

        return exerted


def rate(ref: Reference, joint: int) -> Array:
    """How fast the believed torque changes [N m/s]."""
    step = ref.time[1] - ref.time[0]
    change = np.diff(ref.tau[:, joint], append=ref.tau[-1, joint]) / step
    return np.where(np.diff(ref.recording, append=ref.recording[-1]) == 0, change, 0.0)
