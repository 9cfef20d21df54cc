"""Random throws, each of which hits the H1 if it just stands there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.common.arrays import FloatArray
from bench.humanoid.world.model import World, build_world
from bench.humanoid.world.objects import FlyingObject
from bench.humanoid.world.robot import Setup
from bench.humanoid.world.simulate import Contact, hold, simulate
from bench.humanoid.world.standing import standing_posture
from bench.humanoid.world.throws import DISTANCE, Throw

PREDICT_SPEEDS = (2.0, 4.0)  # [m/s], between
REACT_SPEEDS = (0.25, 0.5, 1.0)  # [m/s], one of
AZIMUTH = np.radians(100.0)  # to either side of straight ahead
ELEVATION = (np.radians(-5.0), np.radians(25.0))
MAX_ARC = 0.5  # [m]
TURNS = 1.0  # from start to aim, at most
AIM_SPREAD = 0.03  # [m]

# The upper body: feet that are held flat leave a leg no way out, since the ankles only pitch.
AIMS: tuple[tuple[str, tuple[float, float, float]], ...] = (  # link, point in its frame [m]
    ("torso_link", (0.0, 0.0, 0.35)),
    ("torso_link", (0.0, 0.0, 0.15)),
    ("torso_link", (0.045, 0.0, 0.68)),
    ("left_shoulder_yaw_link", (0.0, 0.0, -0.05)),
    ("right_shoulder_yaw_link", (0.0, 0.0, -0.05)),
    ("left_elbow_link", (0.15, 0.0, -0.01)),
    ("right_elbow_link", (0.15, 0.0, -0.01)),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Hit:
    """A throw and where it met the standing robot."""

    throw: Throw
    contact: Contact


def draw_throws(
    things: dict[str, FlyingObject], setup: Setup, n: int = 20, seed: int = 0
) -> tuple[list[Hit], int]:
    """Random throws at 2 to 4 m/s that hit the standing H1, and how many were drawn in vain.

    Objects take turns; aim, direction, arc, attitude and tumbling are random. For other speeds see
    Throw.at_speed: the path stays the same.
    """
    rng = np.random.default_rng(seed)
    q = standing_posture(setup)
    names = list(things)
    worlds = {name: build_world(setup, things[name]) for name in names}
    hits: list[Hit] = []
    n_missed = 0
    while len(hits) < n:
        name = names[len(hits) % len(names)]
        throw = random_throw(rng, name, worlds[name], q)
        contact = control_run(worlds[name], throw)
        if contact is None:
            n_missed += 1
        else:
            hits.append(Hit(throw=throw, contact=contact))
    return hits, n_missed


def control_run(world: World, throw: Throw) -> Contact | None:
    """Where the throw meets an H1 that stands still; None if it misses."""
    q = standing_posture(world.setup)
    return simulate(world, q, hold(q), throw=throw, stop_at_contact=True).contact


def random_throw(rng: np.random.Generator, name: str, world: World, q: FloatArray) -> Throw:
    """One throw at the robot in posture q (19,), hit or miss. In front is -y."""
    data = world.standing_data(q)
    link, point = AIMS[rng.integers(len(AIMS))]
    body = world.model.body(link).id
    aim = data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
    aim = aim + rng.uniform(-AIM_SPREAD, AIM_SPREAD, 3)
    azimuth, elevation = rng.uniform(-AZIMUTH, AZIMUTH), rng.uniform(*ELEVATION)
    ahead = [np.sin(azimuth), -np.cos(azimuth)]
    start = aim + DISTANCE * np.array([*(np.cos(elevation) * np.array(ahead)), np.sin(elevation)])
    start[2] = max(start[2], 0.3)  # not out of the floor
    start = aim + DISTANCE * (start - aim) / np.linalg.norm(start - aim)
    attitude, axis = rng.normal(size=3), rng.normal(size=3)
    return Throw(
        object_name=name,
        aim=_triple(aim),
        start=_triple(start),
        speed=float(rng.uniform(*PREDICT_SPEEDS)),
        arc=float(rng.uniform(0, MAX_ARC)) if rng.random() < 0.5 else 0.0,
        attitude=_triple(rng.uniform(0, np.pi) * attitude / np.linalg.norm(attitude)),
        tumble=_triple(rng.uniform(0, 2 * np.pi * TURNS) * axis / np.linalg.norm(axis)),
    )


def _triple(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 6) for value in values)
    return (x, y, z)
