"""What is concealed, and how large: enough to lead the tip astray by millimetres."""

from collections.abc import Callable

import numpy as np

from bench.sim2real.concealed.draft import Draft
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.effects_body import Payload
from bench.sim2real.concealed.effects_drive import Spring, TorqueGain, TorqueOffset
from bench.sim2real.concealed.effects_friction import Coulomb, Stribeck, Viscous
from bench.sim2real.concealed.effects_late import Delay, Lag
from bench.sim2real.concealed.effects_transmission import (
    Backlash,
    Elasticity,
    JointOffset,
    KinematicError,
)

STRAY = 0.007  # of a joint, which the tip feels over half a metre [rad]
LARGE = (0, 1, 3)  # joints that move the tip over long ways
WITH_TIP = (
    *("backlash", "backlash_unloaded", "joint_elasticity"),
    *("joint_offset", "kinematic_error", "several_at_once"),
)
"""Effects beyond the encoders: their recordings hold the tip's measured pose."""

MODEL_ERROR = {"friction_and_inertias": 0.05}
"""Relative error of every inertial figure of the given model, in addition."""


def torques(draft: Draft, joints: tuple[int, ...], rng: np.random.Generator) -> list[float]:
    """Torques that push each joint off by about `STRAY` against its controller [N m]."""
    kp, arm = draft.control.kp, draft.arm
    return [
        float(f"{min(STRAY * kp[j], 0.12 * arm.joints[j].effort) * rng.uniform(0.7, 1.3):.4g}")
        for j in joints
    ]


def _each(
    draft: Draft,
    joints: tuple[int, ...],
    rng: np.random.Generator,
    make: Callable[[int, float], Effect],
) -> tuple[Effect, ...]:
    """An effect at each joint, sized by such a torque."""
    levels = torques(draft, joints, rng)
    return tuple(make(j, level) for j, level in zip(joints, levels, strict=True))


def _stick(draft: Draft, joint: int) -> dict[str, object]:
    return {"joint": joint, "inertia": float(0.8 * draft.ref.lightest[joint])}


def coulomb(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Dry friction in four joints."""
    return _each(draft, (*LARGE, 5), rng, lambda j, tau: Coulomb(**_stick(draft, j), size=tau))


def viscous(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """In three joints, as large as the torques above at 0.5 rad/s."""
    return _each(draft, LARGE, rng, lambda j, tau: Viscous(joint=j, coefficient=2.0 * tau))


def stribeck(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Stribeck friction in two joints, together with Coulomb friction."""
    figures = {"coulomb_ratio": 1.0, "speed": 0.15}
    return _each(
        draft, (0, 3), rng, lambda j, tau: Stribeck(**_stick(draft, j), extra=0.6 * tau, **figures)
    )


def payload(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Two to three kilograms in the hand."""
    com = np.round(rng.uniform([-0.03, -0.03, 0.12], [0.03, 0.03, 0.2]), 4)
    return (Payload(mass=float(np.round(rng.uniform(2.0, 3.0), 3)), com=com),)


def delay(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Commands 15 to 30 ms late, of all joints."""
    kp = tuple(map(float, draft.control.kp))
    late = float(np.round(rng.uniform(0.015, 0.03), 4))
    return (Delay(delay=late, places=tuple(range(draft.arm.n)), kp=kp),)


def lag(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """A lag of all drives, as slow as the controller bears."""
    slowest = 0.35 * float(np.min(draft.control.kd / draft.control.kp))
    return (Lag(time_constant=float(f"{slowest:.3g}"), places=tuple(range(draft.arm.n))),)


def gain(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """The drives of the two joints that carry the arm give too little or too much."""
    return tuple(
        TorqueGain(
            joint=j,
            error=float(np.round(rng.uniform(0.12, 0.2), 4)),
            sign=float(rng.choice([-1, 1])),
        )
        for j in (1, 3)
    )


def offset(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Current sensors with a wrong zero, in three joints."""
    levels = torques(draft, LARGE, rng)
    signs = rng.choice([-1.0, 1.0], 3)
    return tuple(
        TorqueOffset(joint=j, size=level, sign=float(sign))
        for j, level, sign in zip(LARGE, levels, signs, strict=True)
    )


def spring(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """A cable about the first joint, a counterbalance at the fourth."""
    first, fourth = torques(draft, (0, 3), rng)
    return (
        Spring(joint=0, stiffness=2.0 * first, onset=0.1, side=int(rng.choice([-1, 0, 1]))),
        Spring(joint=3, stiffness=1.5 * fourth, onset=-1.7, side=0),
    )


def elasticity(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Gears of joints 2 and 4 that give."""
    effects = []
    for j in (1, 3):
        load = float(np.max(np.abs(draft.ref.tau[:, j])))
        compliance = float(f"{rng.uniform(0.012, 0.02) / load:.4g}")
        body = float(draft.ref.inertia[j] - draft.ref.armature[j])
        damping = float(f"{0.1 * np.sqrt(body / compliance):.4g}")
        effects.append(
            Elasticity(joint=j, compliance=compliance, damping=damping, softest=0.03 / load)
        )
    return tuple(effects)


def _play(draft: Draft, rng: np.random.Generator, j: int, low: float, high: float) -> Effect:
    grease = float(f"{0.5 * (draft.ref.inertia[j] - draft.ref.armature[j]):.4g}")
    return Backlash(joint=j, gap=float(np.round(rng.uniform(low, high), 4)), grease=grease)


def backlash(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Play in the fourth joint's gear."""
    return (_play(draft, rng, 3, 0.02, 0.035),)


def backlash_unloaded(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Play in the first joint's gear, about an upright axis: nothing presses it to one side."""
    return (_play(draft, rng, 0, 0.008, 0.016),)


def joint_offset(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """The zeros of two encoders."""
    sizes = np.round(rng.uniform(0.012, 0.025, 2) * rng.choice([-1.0, 1.0], 2), 4)
    return tuple(
        JointOffset(joint=j, size=abs(float(size)), sign=float(np.sign(size)))
        for j, size in zip((1, 3), sizes, strict=True)
    )


def link_length(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """The upper arm is 6 to 12 mm longer or shorter than its URDF says, and a little crooked."""
    believed = draft.arm.joints[2].T_parent_joint[:3, 3]
    length = rng.choice([-1.0, 1.0]) * rng.uniform(0.006, 0.012)
    shift = np.round(length * believed / np.linalg.norm(believed), 6)
    turn = np.round(rng.uniform(-0.006, 0.006, 3) * [1.0, 0.0, 0.0], 6)
    return (KinematicError(joint=2, shift=shift, turn=turn),)


def several(draft: Draft, rng: np.random.Generator) -> tuple[Effect, ...]:
    """Friction in four joints, a payload, late commands and an encoder's zero, all at once."""
    parts = (*coulomb(draft, rng), *payload(draft, rng), *delay(draft, rng))
    return (*parts, joint_offset(draft, rng)[0])


HIDDEN: dict[str, Callable[[Draft, np.random.Generator], tuple[Effect, ...]]] = {
    "coulomb_friction": coulomb,
    "viscous_friction": viscous,
    "stribeck_friction": stribeck,
    "payload": payload,
    "torque_offset": offset,
    "torque_gain": gain,
    "position_dependent_spring": spring,
    "command_delay": delay,
    "actuator_lag": lag,
    "joint_elasticity": elasticity,
    "backlash": backlash,
    "backlash_unloaded": backlash_unloaded,
    "joint_offset": joint_offset,
    "kinematic_error": link_length,
    "several_at_once": several,
    "friction_and_inertias": coulomb,
}
