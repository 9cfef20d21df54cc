"""Physics outside the catalogue and channels that lie."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.arm import Arm, Array
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_outside import KINDS, Crosstalk, Outside, Slosh
from bench.sim2real.concealed.effects_sensor import LIES, Lie
from bench.sim2real.concealed.scene import Scene


def outside(scene: Scene, kind: str) -> Effect:
    """A law of one of the kinds, sized against the noise."""
    rng, ref = scene.rng, scene.ref
    if kind not in KINDS:
        raise ValueError(f"kind is {kind!r}, expected one of {', '.join(KINDS)}")

    def neighbour(j: int) -> int:
        return j - 1 if j > 0 else 1

    if kind == "crosstalk":
        return scene.somewhere(lambda j: Crosstalk(joint=j, other=neighbour(j)))
    raw = rng.uniform(0.0, 1.0, 3)

    def make(j: int) -> Effect:
        figures = _figures(kind, raw, ref.q[:, j])
        inertia = float(ref.lightest[j])
        return Outside(joint=j, other=neighbour(j), kind=kind, figures=figures, inertia=inertia)

    return scene.somewhere(make)


def _figures(kind: str, raw: Array, q: Array) -> tuple[float, float, float]:
    if kind == "detents":
        a, b, c = np.quantile(q, [0.2 + 0.15 * raw[0], 0.45 + 0.1 * raw[1], 0.65 + 0.15 * raw[2]])
        return float(a), float(b), float(c)
    if kind == "pump":
        return 2.0 * np.pi * (0.4 + 1.5 * raw[0]), 6.28 * raw[1], 6.28 * raw[2]
    if kind == "speed_ripple":
        return 5.0 + 15.0 * raw[0], 6.28 * raw[1], 0.0
    return 6.28 * raw[0], 0.0, 0.0


def slosh(arm: Arm, rng: np.random.Generator) -> Slosh:
    """A load of about a tenth of what the strongest drive holds at full stretch."""
    reach = sum(float(np.linalg.norm(joint.T_parent_joint[:3, 3])) for joint in arm.joints[1:])
    reach += float(np.linalg.norm(arm.T_last_tip[:3, 3]))
    effort = max(joint.effort for joint in arm.joints)
    mass = float(f"{rng.uniform(0.05, 0.12) * effort / (9.81 * reach):.4g}")
    drop, hertz = (float(x) for x in np.round(rng.uniform([0.05, 1.0], [0.15, 2.5]), 3))
    return Slosh(mass=mass, pivot=arm.T_last_tip[:3, 3].copy(), drop=drop, hertz=hertz)


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
