"""What is hidden in bodies, in the IMU, under the feet and in the ground."""

from dataclasses import replace

import numpy as np

from bench.sim2real.legged.draw_joint import Scene
from bench.sim2real.legged.machine import Body, Hidden, Load, Machine
from bench.sim2real.legged.spec import Array
from bench.sim2real.legged.world import body_of


def by_axis(name: str, vector: Array) -> dict[str, float]:
    """Parameters NAME_x, NAME_y, NAME_z."""
    return {f"{name}_{axis}": float(value) for axis, value in zip("xyz", vector, strict=True)}


def payload(scene: Scene) -> tuple[Machine, Hidden]:
    """A box on the trunk."""
    machine, rng, robot = scene.machine, scene.rng, scene.machine.robot
    small = robot.name == "go2"
    mass = float(rng.uniform(1.0, 4.0) if small else rng.uniform(3.0, 8.0))
    low, high = _PLACES[robot.name]
    com = rng.uniform(low, high)
    load = Load(link=robot.trunk, mass=mass, com=(com[0], com[1], com[2]), size=0.12)
    figures = {"mass": mass, **by_axis("com", com)}
    hidden = Hidden(effect="payload", links=(robot.trunk,), parameters=figures)
    return replace(machine, loads=(*machine.loads, load)), hidden


_PLACES = {
    "go2": (np.array([-0.15, -0.06, 0.06]), np.array([0.15, 0.06, 0.15])),
    "h1": (np.array([-0.16, -0.10, 0.05]), np.array([0.10, 0.10, 0.40])),
}
"""Corners between which the box lies, in the trunk's frame [m]."""


def link_inertial_error(scene: Scene) -> tuple[Machine, Hidden]:
    """A leg's link that is heavier than drawn, and elsewhere."""
    machine, rng, robot = scene.machine, scene.rng, scene.machine.robot
    link = str(rng.choice(robot.heavy))
    mass, com = body_of(robot, link)
    before = machine.bodies.get(link, Body())
    extra = rng.uniform(0.3, 0.7) * max(mass, _FELT[robot.name])
    shift = np.array(before.shift) + rng.uniform(-0.02, 0.02, 3)
    scale = before.scale + float(extra) / mass
    body = Body(scale=scale, shift=(float(shift[0]), float(shift[1]), float(shift[2])))
    moment = scale * mass * (com + shift) - mass * com
    figures = {"d_mass": mass * (scale - 1.0)}
    figures |= by_axis("d_first_moment", moment)
    changed = replace(machine, bodies={**machine.bodies, link: body})
    return changed, Hidden(effect="link_inertial_error", links=(link,), parameters=figures)


_FELT = {"go2": 0.4, "h1": 0.75}
"""Mass of a link from which shares of it are felt; lighter ones get as much as these [kg]."""


def imu_offset(scene: Scene) -> tuple[Machine, Hidden]:
    """Zeros of gyro and accelerometer."""
    machine, rng = scene.machine, scene.rng
    gyro = machine.gyro_bias + _way(rng) * rng.uniform(0.02, 0.05)
    acc = machine.acc_bias + _way(rng) * rng.uniform(0.2, 0.6)
    figures = by_axis("gyro", gyro)
    figures |= by_axis("acc", acc)
    hidden = Hidden(effect="imu_offset", links=(machine.robot.base,), parameters=figures)
    return replace(machine, gyro_bias=gyro, acc_bias=acc), hidden


def imu_tilt(scene: Scene) -> tuple[Machine, Hidden]:
    """An IMU that is not screwed on straight."""
    machine, rng = scene.machine, scene.rng
    tilt = machine.imu_tilt + _way(rng) * np.radians(rng.uniform(2.0, 5.0))
    figures = by_axis("tilt", tilt)
    hidden = Hidden(effect="imu_tilt", links=(machine.robot.base,), parameters=figures)
    return replace(machine, imu_tilt=tilt), hidden


def foot_friction(scene: Scene) -> tuple[Machine, Hidden]:
    """Feet that slip."""
    feet, names = _feet(scene)
    low, high = _SLIPPERY[scene.machine.robot.name]
    value = float(scene.rng.uniform(low, high))
    changed = scene.machine.at("friction", feet, value)
    return changed, Hidden(effect="foot_friction", feet=names, parameters={"friction": value})


_SLIPPERY = {"go2": (0.22, 0.35), "h1": (0.18, 0.28)}
"""Friction at which the motions slip at times and the robot does not fall for it."""


def foot_softness(scene: Scene) -> tuple[Machine, Hidden]:
    """Feet that give by millimetres."""
    feet, names = _feet(scene)
    value = float(scene.rng.uniform(0.04, 0.1) * scene.machine.robot.stiffness)
    changed = scene.machine.at("stiffness", feet, value)
    return changed, Hidden(effect="foot_softness", feet=names, parameters={"stiffness": value})


def _feet(scene: Scene) -> tuple[list[int], tuple[str, ...]]:
    """All, or one."""
    names = scene.machine.robot.feet
    if scene.rng.random() < 0.5:
        return list(range(len(names))), names
    k = int(scene.rng.integers(len(names)))
    return [k], (names[k],)


def ground_slope(scene: Scene) -> tuple[Machine, Hidden]:
    """A floor that falls to a side."""
    angle, way = np.radians(scene.rng.uniform(2.0, 5.0)), scene.rng.uniform(0.0, 2.0 * np.pi)
    slope = angle * np.array([np.cos(way), np.sin(way)])
    figures = {"tilt_x": float(slope[0]), "tilt_y": float(slope[1])}
    hidden = Hidden(effect="ground_slope", feet=scene.machine.robot.feet, parameters=figures)
    return replace(scene.machine, slope=slope), hidden


def ground_height(scene: Scene) -> tuple[Machine, Hidden]:
    """A floor that is higher or lower than the study says."""
    height = float(scene.sign() * scene.rng.uniform(0.01, 0.03))
    hidden = Hidden(
        effect="ground_height", feet=scene.machine.robot.feet, parameters={"height": height}
    )
    return replace(scene.machine, ground=height), hidden


def _way(rng: np.random.Generator) -> Array:
    """A direction, (3,)."""
    way = rng.normal(size=3)
    return np.asarray(way / np.linalg.norm(way))
