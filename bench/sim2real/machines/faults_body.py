"""Faults of bodies, of the mounting and of the log as a whole."""

from collections.abc import Callable

import numpy as np

from bench.sim2real.frame.arm import Arm, Link, pose
from bench.sim2real.machines.fault import Fault, Log, Scene
from bench.sim2real.machines.figures import Array


def _loaded(
    scene: Scene, index: int, place: Array, inertia: Callable[[float], float], share: float
) -> tuple[Callable[[Arm], Arm], float]:
    """A body on a link, so heavy that the torques change by this share of the rated ones."""

    def make(mass: float) -> Callable[[Arm], Arm]:
        body = Link(mass=mass, com=place, inertia=inertia(mass) * np.eye(3))
        return lambda arm: arm.with_link(index, arm.links[index].plus(body))

    mass = 1.0
    for _ in range(4):
        mass *= share / max(scene.change(make(mass)), 1e-9)
    mass = float(f"{mass:.3g}")
    return make(mass), mass


def payload(scene: Scene) -> Fault:
    """A gripper or a part that the model does not have."""
    place = scene.machine.arm.T_last_tip[:3, 3] + scene.rng.normal(0.0, 0.03, 3)
    width, last = scene.uniform(0.04, 0.1), scene.n - 1
    share = scene.size(0.06, 0.18, 0.3)
    arm, mass = _loaded(scene, last, place, lambda mass: mass / 6.0 * width**2, share)
    return Fault(links=(last,), parameters={"mass": mass}, arm=arm)


def link_inertial_error(scene: Scene) -> Fault:
    """A motor, a cover or a counterweight that the model lacks."""
    index = int(scene.rng.integers(max(0, scene.n // 3), max(1, scene.n - 1)))
    link = scene.machine.arm.links[index]
    size = float(np.sqrt(np.trace(link.inertia) / link.mass))
    place = link.com + size * scene.rng.normal(0.0, 0.5, 3)
    share = scene.size(0.06, 0.15, 0.3)
    arm, mass = _loaded(scene, index, place, lambda mass: mass * 1e-3, share)
    return Fault(links=(index,), parameters={"d_mass": mass}, arm=arm)


def gravity_direction(scene: Scene) -> Fault:
    """A base that is not level."""
    about, tilt = scene.uniform(0.0, 6.28), scene.size(0.04, 0.12, 0.3)
    direction = 9.81 * np.array([np.sin(tilt) * np.cos(about), np.sin(tilt) * np.sin(about), 0.0])
    direction[2] = -9.81 * np.cos(tilt)
    x, y, z = map(float, direction)
    return Fault(
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
    return Fault(joints=(j,), arm=lambda arm: arm.with_placement(j, placement))


def external_contact(scene: Scene) -> Fault:
    """Somebody leans on the tool for some seconds of one recording."""
    which = int(scene.rng.integers(scene.recordings))
    start = scene.uniform(3.0, scene.duration - 8.0)
    end = float(f"{start + scene.rng.uniform(2.0, 5.0):.3g}")
    force = scene.rng.normal(size=3)
    size = scene.size(0.25, 0.5, 0.8) * float(np.max(scene.machine.rated)) / scene.reach()
    force *= size / np.linalg.norm(force)

    def push(recording: int, ticks: int, rng: np.random.Generator) -> Array:
        time = 1e-3 * np.arange(ticks)
        rise = np.clip(np.minimum(time - start, end - time) / 0.3, 0.0, 1.0)
        return np.outer(rise * (recording == which), force)

    return Fault(
        recordings=(which,),
        window=(start, end),
        parameters={f"force_{axis}": float(f) for axis, f in zip("xyz", force, strict=True)},
        push=push,
    )


def timestamp_skew(scene: Scene) -> Fault:
    """Torques that come from another computer, later."""
    late = scene.size(0.02, 0.06, 0.15)

    def change(log: Log, rng: np.random.Generator) -> None:
        for j in range(log["tau"].shape[1]):
            log["tau"][:, j] = np.interp(log["time"] - late, log["time"], log["tau"][:, j])

    return Fault(joints=tuple(range(scene.n)), parameters={"skew": late}, log=change)
