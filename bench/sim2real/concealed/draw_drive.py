"""Random faults of drives, sized against the noise."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_drive import (
    Ripple,
    Saturation,
    Spring,
    TorqueGain,
    TorqueOffset,
)
from bench.sim2real.concealed.effects_late import Delay, Lag
from bench.sim2real.concealed.scene import Scene
from bench.sim2real.concealed.sizing import multiple


def gain(scene: Scene) -> Effect:
    """A wrong torque constant, or a wrong sensor."""
    sign = scene.sign()
    by_drive = not scene.torque_logged or bool(scene.rng.random() < 0.5)
    return scene.somewhere(
        lambda j: TorqueGain(joint=j, gate=scene.gate, sign=sign, by_drive=by_drive)
    )


def offset(scene: Scene) -> Effect:
    """A current sensor's zero."""
    sign = scene.sign()
    by_drive = not scene.torque_logged or bool(scene.rng.random() < 0.5)
    return scene.somewhere(
        lambda j: TorqueOffset(joint=j, gate=scene.gate, sign=sign, by_drive=by_drive)
    )


def saturation(scene: Scene) -> Effect:
    """Above what holds the arm, below what the motion asks for."""
    tau, ref = np.abs(scene.ref.tau), scene.ref
    some = range(0, len(ref.q), 10)
    holding = np.max([np.abs(ref.dynamics.gravity(ref.q[row])) for row in some], axis=0)
    peak = np.max(tau, axis=0)
    room = sorted(scene.places, key=lambda j: holding[j] / peak[j])[: max(2, ref.arm.n // 2)]

    def make(j: int) -> Effect:
        return Saturation(joint=j, depth=0.1, peak=float(peak[j]), floor=float(1.15 * holding[j]))

    return make(next(j for j in scene.places if j in room))


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

    def make(j: int) -> Effect:
        q = scene.ref.q[:, j]
        quantile = 0.5 if side == 0 else (share if side > 0 else 1.0 - share)
        return Spring(joint=j, side=side, onset=float(np.round(np.quantile(q, quantile), 3)))

    return scene.somewhere(make)


def delay(scene: Scene) -> Effect:
    """Positions late on a bus, for all joints or one; or torques late in the drives."""
    rng, control = scene.rng, scene.control
    n = scene.ref.arm.n
    kp = tuple(map(float, control.kp))
    places = tuple(range(n)) if rng.random() < 0.6 else (scene.places[0],)
    if scene.torque_logged and rng.random() < 0.3:
        late = scene.sized(Delay(places=places, of="tau_cmd", kp=kp))
        late = late.scaled(min(late.delay, bearable_delay(scene)))
        if multiple(late, scene.ref, scene.sensors) > 0.7 * scene.size:
            return late
    effect = scene.sized(Delay(places=places, kp=kp))
    if scene.size > 5.0:  # far above the noise: delays that are met, not the least visible
        effect = effect.scaled(max(effect.delay, scene.uniform(0.005, 0.05)))
    return effect


def lag(scene: Scene) -> Effect:
    """Of all drives or one, as slow as the controller bears."""
    n, control = scene.ref.arm.n, scene.control
    slowest = 0.35 * float(np.min(control.kd / control.kp))
    together = scene.rng.random() < 0.6

    def make(j: int) -> Effect:
        return Lag(places=tuple(range(n)) if together else (j,), slowest=float(f"{slowest:.4g}"))

    return scene.somewhere(make)


def bearable_delay(scene: Scene) -> float:
    """A delay that takes 0.7 rad of the controller's phase at its fastest [s]."""
    ref = scene.ref
    M = ref.dynamics.mass_matrix(ref.q[0])
    fastest = float(np.max(np.linalg.eigvals(np.linalg.solve(M, np.diag(scene.control.kd))).real))
    return float(f"{0.7 / fastest:.4g}")
