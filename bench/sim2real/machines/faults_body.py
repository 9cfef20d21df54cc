"""Faults of bodies, of the mounting and of the log as a whole."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bench.sim2real.concealed.arm import Arm, Link, pose
from bench.sim2real.machines.fault import Fault, Log, Scene
from bench.sim2real.machines.figures import Array


def _sized(scene: Scene, make: Callable[[float], Callable[[Arm], Arm]], share: float) -> float:
    """The size at which the torques change by this share of the rated ones."""
    size = 1.0
    for _ in range(4):
        size *= share / max(scene.change(make(size)), 1e-9)
    return float(f"{size:.3g}")


def _with(index: int, body: Link) -> Callable[[Arm], Arm]:
    return lambda arm: arm.with_link(index, arm.links[index].plus(body))


def payload(scene: Scene) -> Fault:
    """A gripper or a part that nobody told of."""
    last = scene.n - 1
    place = scene.machine.arm.T_last_tip[:3, 3] + scene.rng.normal(0.0, 0.03, 3)
    width = scene.uniform(0.04, 0.1)

    def make(mass: float) -> Callable[[Arm], Arm]:
        inertia = mass / 6.0 * width**2 * np.eye(3)
        return _with(last, Link(mass=mass, com=place, inertia=inertia))

    mass = _sized(scene, make, scene.size(0.06, 0.18, 0.3))
    return Fault(
        kind="payload",
        effect="payload",
        links=(last,),
        parameters={"mass": mass},
        arm=make(mass),
    )


def link_inertial_error(scene: Scene) -> Fault:
    """A motor, a cover or a counterweight that the model lacks."""
    index = int(scene.rng.integers(max(0, scene.n // 3), max(1, scene.n - 1)))
    link = scene.machine.arm.links[index]
    size = float(np.sqrt(np.trace(link.inertia) / link.mass))
    place = link.com + size * scene.rng.normal(0.0, 0.5, 3)

    def make(mass: float) -> Callable[[Arm], Arm]:
        return _with(index, Link(mass=mass, com=place, inertia=mass * 1e-3 * np.eye(3)))

    mass = _sized(scene, make, scene.size(0.06, 0.15, 0.3))
    return Fault(
        kind="link_inertial_error",
        effect="link_inertial_error",
        links=(index,),
        parameters={"d_mass": mass},
        arm=make(mass),
    )


def gravity_direction(scene: Scene) -> Fault:
    """A base that is not level."""
    about, tilt = scene.uniform(0.0, 6.28), scene.size(0.04, 0.12, 0.3)
    direction = 9.81 * np.array([np.sin(tilt) * np.cos(about), np.sin(tilt) * np.sin(about), 0.0])
    direction[2] = -9.81 * np.cos(tilt)
    x, y, z = map(float, direction)
    return Fault(
        kind="gravity_direction",
        effect="gravity_direction",
        parameters={"tilt": tilt},
        figures=lambda figures: figures.with_whole(gravity_x=x, gravity_y=y, gravity_z=z),
    )


def kinematic_error(scene: Scene) -> Fault:
    """A link that was bent or mounted on the wrong shim."""
    j = int(scene.rng.integers(1, scene.n))
    shift = scene.rng.normal(size=3)
    shift *= scene.size(0.01, 0.03, 0.1) / np.linalg.norm(shift)
    turn = scene.rng.normal(size=3)
    turn *= scene.size(0.03, 0.08, 0.25) / np.linalg.norm(turn)
    placement = scene.machine.arm.joints[j].T_parent_joint @ pose(shift, turn)
    return Fault(
        kind="kinematic_error",
        effect="kinematic_error",
        joints=(j,),
        parameters={},
        arm=lambda arm: arm.with_placement(j, placement),
    )


def external_contact(scene: Scene) -> Fault:
    """Somebody leans on the tool for some seconds of one recording."""
    which = int(scene.rng.integers(scene.recordings))
    start = scene.uniform(3.0, scene.duration - 8.0)
    end = float(f"{start + scene.rng.uniform(2.0, 5.0):.3g}")
    reach = 0.2 + float(
        np.sum([np.linalg.norm(j.T_parent_joint[:3, 3]) for j in scene.machine.arm.joints])
    )
    force = scene.rng.normal(size=3)
    force *= (
        scene.size(0.25, 0.5, 0.8)
        * float(np.max(scene.machine.rated))
        / reach
        / np.linalg.norm(force)
    )

    def push(recording: int, ticks: int, rng: np.random.Generator) -> Array:
        time = 1e-3 * np.arange(ticks)
        rise = np.clip(np.minimum(time - start, end - time) / 0.3, 0.0, 1.0)
        return np.outer(rise * (recording == which), force)

    return Fault(
        kind="external_contact",
        effect="external_contact",
        recordings=(which,),
        window=(start, end),
        parameters={
            name: float(f) for name, f in zip(("force_x", "force_y", "force_z"), force, strict=True)
        },
        push=push,
    )


def timestamp_skew(scene: Scene) -> Fault:
    """Torques that come from another computer, later."""
    late = scene.size(0.02, 0.06, 0.15)

    def change(log: Log, rng: np.random.Generator) -> None:
        for j in range(log["tau"].shape[1]):
            log["tau"][:, j] = np.interp(log["time"] - late, log["time"], log["tau"][:, j])

    return Fault(
        kind="timestamp_skew",
        effect="timestamp_skew",
        joints=tuple(range(scene.n)),
        parameters={"skew": late},
        log=change,
    )
