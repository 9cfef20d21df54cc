"""The arms, where they may be, and how far coal says that they are from things."""

import time
from collections.abc import Callable, Iterable
from typing import Any

import coal
import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.safety.report import Jobs

ARMS = ("panda", "ur10", "iiwa14")
REPEATS = 3  # of each solve, the fastest of which counts: other programs are running
TOUCHES = 1e-5  # what coal may find deeper before an answer is wrong [m]

Pose = tuple[Any, Any]
"""A shape of coal's and where it is."""


def transform(T: FloatArray) -> Any:
    """Coal's."""
    return coal.Transform3s(T[:3, :3], T[:3, 3])


def capsules(robot: pdoik.Robot, q: FloatArray) -> list[Pose]:
    """What the robot fills."""
    found = []
    for link, one, other, radius, *_ in robot.occupancy.capsules:
        T = np.asarray(robot.fk(q, link))
        a, b = (T[:3, :3] @ end + T[:3, 3] for end in (one, other))
        length = float(np.linalg.norm(b - a))
        placed = coal.Transform3s.Identity()
        if length > 1e-9:
            turn = coal.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), (b - a) / length)
            placed.setRotation(turn.toRotationMatrix())
        placed.setTranslation((a + b) / 2)
        found.append((coal.Capsule(radius, length), placed))
    return found


def distance(robot: pdoik.Robot, q: FloatArray, things: Iterable[Pose]) -> float:
    """From the robot to the nearest thing [m]."""
    placed = capsules(robot, q)
    least = np.inf
    for shape, T in things:
        for body, T_body in placed:
            request, result = coal.DistanceRequest(), coal.DistanceResult()
            least = min(least, coal.distance(body, T_body, shape, T, request, result))
    return float(least)


def free_configurations(
    robot: pdoik.Robot, rng: np.random.Generator, count: int
) -> list[FloatArray]:
    """Off itself."""
    solver, free = pdoik.Solver(robot), []
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    while len(free) < count:
        q = rng.uniform(low, high)
        if solver.judge(robot.fk(q), q).success:
            free.append(q)
    return free


def fastest(ask: Callable[[], pdoik.Result]) -> tuple[float, pdoik.Result]:
    """Of a few times [s], and what it found."""
    ask()
    least = np.inf
    for _ in range(REPEATS):
        began = time.perf_counter()
        result = ask()
        least = min(least, time.perf_counter() - began)
    return least, result


def jobs_of(sizes: Iterable[int], size: int, seed: int) -> Jobs:
    """One of each arm and number of things."""
    return {
        f"{count:07d}-{arm}": {"arm": arm, "count": count, "cases": size, "seed": seed}
        for count in sizes
        for arm in ARMS
    }
