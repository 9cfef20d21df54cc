"""Commands that act late: transport delay and first order lag."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from bench.sim2real.concealed.effect import Drive, Effect, Scene, effect, multiple
from bench.sim2real.concealed.reference import Reference
from bench.sim2real.concealed.world import TIMESTEP, Run
from bench.sim2real.frame.arm import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Late(Effect):
    """Lateness of all joints, or of some."""

    places: tuple[int, ...] = ()

    def joints(self, ref: Reference) -> tuple[int, ...]:
        return self.places


@effect("command_delay", "delay", bounds=(0.0015, 0.08))
class Delay(Late):
    """Commands act late: positions sent over a bus, or torques inside the drives."""

    delay: float = 0.01
    of: str = "q_des"  # or tau_cmd
    kp: tuple[float, ...] = ()

    def residual(self, ref: Reference) -> Array:
        """What the control law's torque changes, roughly, (T, n) [N m]."""
        result = np.zeros_like(ref.q)
        for j in self.places:
            if self.of == "q_des":
                result[:, j] = self.delay * self.kp[j] * ref.dq[:, j]
            else:
                result[:, j] = self.delay * rate(ref, j)
        return result

    def change_command(self, time: Array, q_des: Array, dq_des: Array) -> tuple[Array, Array]:
        if self.of != "q_des":
            return q_des, dq_des
        q_des, dq_des = q_des.copy(), dq_des.copy()
        for j in self.places:
            q_des[:, j] = np.interp(time - self.delay, time, q_des[:, j])
            dq_des[:, j] = np.interp(time - self.delay, time, dq_des[:, j])
        return q_des, dq_des

    def drive(self, run: Run) -> Drive | None:
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


@effect("actuator_lag", "time_constant")
class Lag(Late):
    """Torque follows the command with a time constant."""

    time_constant: float = 0.005
    slowest: float = 0.03  # that the controller bears [s]

    def limits(self, ref: Reference) -> tuple[float, float]:
        return 0.001, max(0.001, min(self.slowest, 0.04))

    def residual(self, ref: Reference) -> Array:
        """What the control law's torque changes, roughly, (T, n) [N m]."""
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


def delay(scene: Scene) -> Effect:
    """Positions late on a bus, for all joints or one; or torques late in the drives.

    Torques at most by what takes 0.7 rad of the controller's phase at its fastest.
    """
    rng, control, ref = scene.rng, scene.control, scene.ref
    kp = tuple(map(float, control.kp))
    places = tuple(range(ref.arm.n)) if rng.random() < 0.6 else (scene.places[0],)
    if scene.torque_logged and rng.random() < 0.3:
        late = scene.sized(Delay(places=places, of="tau_cmd", kp=kp))
        M = ref.dynamics.mass_matrix(ref.q[0])
        fastest = float(np.max(np.linalg.eigvals(np.linalg.solve(M, np.diag(control.kd))).real))
        late = late.scaled(min(late.delay, float(f"{0.7 / fastest:.4g}")))
        if multiple(late, ref, scene.sensors) > 0.7 * scene.size:
            return late
    effect = scene.sized(Delay(places=places, kp=kp))
    if scene.size > 5.0:  # far above the noise: delays that are met, not the least visible
        effect = effect.scaled(max(effect.delay, scene.uniform(0.005, 0.05)))
    return effect


def lag(scene: Scene) -> Effect:
    """A lag of all drives or one, as slow as the controller bears."""
    slowest = float(f"{0.35 * float(np.min(scene.control.kd / scene.control.kp)):.4g}")
    together = tuple(range(scene.ref.arm.n)) if scene.rng.random() < 0.6 else ()
    return scene.somewhere(lambda j: Lag(places=together or (j,), slowest=slowest))
