"""An arm as MuJoCo simulates it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bench.sim2real.frame.arm import Arm, Array, quaternion, words


@dataclass(slots=True)
class Machine:
    """What MuJoCo simulates beyond the chain: one entry per joint."""

    armature: list[float]  # [kg m^2]
    damping: list[float]  # [N m s/rad]
    frictionloss: list[float]  # [N m]
    series: dict[int, str] = field(default_factory=dict)  # second hinge's attributes, by joint
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    tendons: list[str] = field(default_factory=list)
    extra: str = ""  # bodies in the last body

    @classmethod
    def of(cls, armature: Array) -> Machine:
        n = len(armature)
        return cls(list(map(float, armature)), [0.0] * n, [0.0] * n)


def mjcf(arm: Arm, machine: Machine, timestep: float) -> str:
    """The arm as MuJoCo simulates it; joint k is `m{k}`, a second hinge in series `s{k}`."""
    head = (
        f'<mujoco><compiler angle="radian" autolimits="false"/>'
        f'<option timestep="{timestep:.9g}" gravity="{words(machine.gravity)}"'
        f' integrator="implicitfast"><flag contact="disable"/></option><worldbody>'
    )
    body = ""
    for k, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        T, J = joint.T_parent_joint, link.inertia
        full = (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
        body += (
            f'<body name="b{k}" pos="{words(T[:3, 3])}" quat="{words(quaternion(T[:3, :3]))}">'
            f'<inertial pos="{words(link.com)}" mass="{link.mass:.9g}"'
            f' fullinertia="{words(np.array(full))}"/>'
            f'<joint name="m{k}" type="hinge" axis="{words(joint.axis)}"'
            f' armature="{machine.armature[k]:.9g}" damping="{machine.damping[k]:.9g}"'
            f' frictionloss="{machine.frictionloss[k]:.9g}"'
            f' solreffriction="{2.2 * timestep:.9g} 1" solimpfriction="0.97 0.99 0.001 0.5 2"/>'
        )
        if k in machine.series:
            body += (
                f'<joint name="s{k}" type="hinge" axis="{words(joint.axis)}" {machine.series[k]}/>'
            )
    T = arm.T_last_tip
    tip = f'<site name="tip" pos="{words(T[:3, 3])}" quat="{words(quaternion(T[:3, :3]))}"/>'
    tail = "</body>" * arm.n + "</worldbody>"
    tendon = f"<tendon>{''.join(machine.tendons)}</tendon>" if machine.tendons else ""
    return head + body + tip + machine.extra + tail + tendon + "</mujoco>"
