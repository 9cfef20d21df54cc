"""One machine's true figures, and what is hidden in it as the truth tells it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from bench.sim2real.legged.robots import Robot
from bench.sim2real.legged.spec import Array

FRICTION = 0.8  # of feet on the ground, as the study says


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """A box that is bolted to a link and not in the description."""

    link: str
    mass: float  # [kg]
    com: tuple[float, float, float]  # in the link's frame [m]
    size: float  # edge of the box [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """How a link differs from its description."""

    scale: float = 1.0  # of mass and inertia
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the centre of mass [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """Arrays are in the order of the robot's joints or feet."""

    robot: Robot
    coulomb: Array  # (n,) [N m]
    viscous: Array  # (n,) [N m s/rad]
    drive_gain: Array  # (n,) delivered over commanded; the drive says what was commanded
    sensor_gain: Array  # (n,) said over delivered
    sensor_offset: Array  # (n,) said less delivered [N m]
    rotor: Array  # (n,) at the joint [kg m^2]
    joint_offset: Array  # (n,) true position less the encoder's [rad]
    spring: Array  # (n,) stiffness [N m/rad]
    spring_rest: Array  # (n,) where it does not pull [rad]
    limit: Array  # (n,) of the commanded torque [N m]
    delay: Array  # (n,) of the commanded position [s]
    gap: Array  # (n,) whole play [rad]
    friction: Array  # (feet,) on the ground
    stiffness: Array  # (feet,) on the ground [N/m]
    imu_tilt: Array  # (3,) turns the given frame to the true one, rotation vector [rad]
    gyro_bias: Array  # (3,) [rad/s]
    acc_bias: Array  # (3,) [m/s^2]
    slope: Array  # (2,) of the ground about x and y [rad]
    ground: float = 0.0  # its height at the origin [m]
    bodies: dict[str, Body] = field(default_factory=dict)  # by link
    loads: tuple[Load, ...] = ()

    def at(self, name: str, index: int | list[int], value: float) -> Machine:
        """The same with one joint's or foot's figure, or those of some."""
        figures = getattr(self, name).copy()
        figures[index] = value
        return replace(self, **{name: figures})

    def facts(self) -> dict[str, Any]:
        """All that is true, as plain data."""
        names = [name for name in self.__slots__ if name not in ("robot", "bodies", "loads")]
        values = {name: np.asarray(getattr(self, name)).tolist() for name in names}
        values["bodies"] = {
            link: {"scale": body.scale, "shift": list(body.shift)}
            for link, body in self.bodies.items()
        }
        return values


def as_given(robot: Robot) -> Machine:
    n, feet = robot.n, len(robot.feet)
    zero, one = np.zeros(n), np.ones(n)
    return Machine(
        robot=robot,
        coulomb=zero,
        viscous=zero,
        drive_gain=one,
        sensor_gain=one,
        sensor_offset=zero,
        rotor=robot.rotor.copy(),
        joint_offset=zero,
        spring=zero,
        spring_rest=zero,
        limit=robot.effort.copy(),
        delay=zero,
        gap=zero,
        friction=np.full(feet, FRICTION),
        stiffness=np.full(feet, robot.stiffness),
        imu_tilt=np.zeros(3),
        gyro_bias=np.zeros(3),
        acc_bias=np.zeros(3),
        slope=np.zeros(2),
    )


def dense(robot: Robot, links: list[str], rng: np.random.Generator) -> Machine:
    """A machine as they are: it rubs everywhere, and nothing is quite what it was said to be.

    Args:
        robot: as its maker says.
        links: those with a mass.
        rng: of the machine.
    """

    def off(low: float, high: float, size: int) -> Array:
        return 1.0 + rng.choice([-1.0, 1.0], size) * rng.uniform(low, high, size)

    n, given = robot.n, as_given(robot)
    bodies = {
        link: Body(scale=float(scale), shift=_triple(rng.normal(0.0, 0.002, 3)))
        for link, scale in zip(links, off(0.03, 0.05, len(links)), strict=True)
    }
    return replace(
        given,
        coulomb=robot.effort * rng.uniform(0.008, 0.02, n),
        viscous=robot.effort * rng.uniform(0.002, 0.006, n),
        sensor_gain=off(0.01, 0.02, n),
        sensor_offset=robot.effort * rng.normal(0.0, 0.003, n),
        rotor=robot.rotor * off(0.03, 0.1, n),
        imu_tilt=rng.normal(0.0, np.radians(0.3) / np.sqrt(3.0), 3),
        gyro_bias=rng.normal(0.0, 0.002, 3),
        acc_bias=rng.normal(0.0, 0.03, 3),
        stiffness=given.stiffness * rng.uniform(0.8, 1.25, len(robot.feet)),
        bodies=bodies,
    )


def _triple(values: Array) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """One cause: its name, its place, its figures in the catalogue's names and units."""

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    feet: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)
