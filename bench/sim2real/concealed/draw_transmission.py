"""Random faults of gears, geometry and channels, sized against the noise."""

from __future__ import annotations

import numpy as np

from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_sensor import SensorGain, SensorNoise, Skew
from bench.sim2real.concealed.effects_transmission import (
    Backlash,
    Coupling,
    Elasticity,
    JointOffset,
    KinematicError,
)
from bench.sim2real.concealed.scene import Scene


def backlash(scene: Scene) -> Effect:
    """At a joint whose load changes sides, where there is one; its size is found by simulating."""
    load = scene.load()
    sides = np.minimum(np.mean(load > 0.0, axis=0), np.mean(load < 0.0, axis=0))
    loaded = scene.loaded()
    joint = next((j for j in loaded if sides[j] > 0.15), loaded[0])
    inertia = float(scene.ref.inertia[joint] - scene.ref.armature[joint])
    grease = float(f"{inertia * scene.rng.uniform(0.3, 1.0):.4g}")
    return Backlash(joint=joint, gap=scene.uniform(0.004, 0.02), grease=grease)


def elasticity(scene: Scene) -> Effect:
    """The locked link swings at 5 to 12 Hz, never where it would sag by more than 3 degrees."""
    ref = scene.ref
    body = ref.inertia - ref.armature
    loaded = scene.loaded()
    share = body / ref.armature  # of a link that swings against a light rotor more is seen
    least = 0.1 if scene.sensors.tip else 0.6
    heaviest = max(scene.places, key=lambda j: share[j])
    joint = next((j for j in loaded if share[j] > least), heaviest)
    stiffness = body[joint] * (2.0 * np.pi * scene.uniform(5.0, 12.0)) ** 2
    load = float(np.max(np.abs(ref.tau[:, joint])))
    stiffness = max(stiffness, load / 0.05)
    ratio = scene.uniform(0.03, 0.12)
    damping = float(f"{2.0 * ratio * np.sqrt(stiffness * body[joint]):.4g}")
    compliance = 1.0 / float(f"{stiffness:.5g}")
    return Elasticity(joint=joint, compliance=compliance, damping=damping, softest=0.07 / load)


def joint_offset(scene: Scene) -> Effect:
    """An encoder's zero."""
    sign = scene.sign()
    return scene.somewhere(lambda j: JointOffset(joint=j, sign=sign))


def kinematic_error(scene: Scene) -> Effect:
    """A length, a twist or both; what an encoder's zero or a slide along an axis does is left."""
    rng, arm = scene.rng, scene.ref.arm
    kind = rng.choice(3, p=[0.5, 0.25, 0.25])
    raw_shift, raw_turn = rng.normal(size=3), rng.normal(size=3)

    def make(j: int) -> Effect:
        R = arm.joints[j].T_parent_joint[:3, :3]
        own, parent = R @ arm.joints[j].axis, arm.joints[max(j - 1, 0)].axis
        shift, turn = across(raw_shift, own, parent), R.T @ across(raw_turn, own, parent)
        shift = 0.005 * shift if kind != 1 else np.zeros(3)
        turn = 0.01 * turn if kind != 0 else np.zeros(3)
        return KinematicError(joint=j, shift=np.round(shift, 6), turn=np.round(turn, 6))

    places = [j for j in scene.places if j > 0] or [1]
    return scene.somewhere(make, places)


def across(vector: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """A unit vector without the parts along two axes."""
    axes = np.linalg.svd(np.column_stack([first, second]))
    span = axes[0][:, : int(np.sum(axes[1] > 1e-2))]
    rest = vector - span @ (span.T @ vector)
    return rest / np.linalg.norm(rest)


def coupling(scene: Scene) -> Effect:
    """A joint moved too by its neighbour's motor."""
    sign = scene.sign()

    def make(k: int) -> Effect:
        return Coupling(joint=k, other=k - 1 if k > 0 else 1, sign=sign)

    return scene.somewhere(make, [k for k in scene.places if k > 0] or [0])


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
