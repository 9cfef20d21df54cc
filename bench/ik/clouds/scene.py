"""The scene that clouds are timed on: a table and seven balls on it, with any number of points."""

import numpy as np

import pdoik
from bench.common.arrays import FloatArray

BALLS = 7
TABLE_HEIGHT = -0.1  # [m]
TABLE_RADII = (0.2, 1.225)  # it is a ring about the robot's foot [m]


def table_and_balls(count: int, seed: int) -> FloatArray:
    """Half of the points on the table, half on the balls, drawn at random, (count, 3) [m].

    The scene is the same for every count: pdoik_bench's SolveAmong has one like it.
    """
    scene, rng = np.random.default_rng(seed), np.random.default_rng([seed, count])
    angles = 0.9 * np.arange(BALLS)
    away, radii = scene.uniform(0.45, 0.75, BALLS), scene.uniform(0.04, 0.1, BALLS)
    balls = np.column_stack([away * np.cos(angles), away * np.sin(angles), radii + TABLE_HEIGHT])

    on_table = count - count // 2
    angle = rng.uniform(-np.pi, np.pi, on_table)
    ring = np.sqrt(rng.uniform(*np.square(TABLE_RADII), on_table))
    table = np.column_stack(
        [ring * np.cos(angle), ring * np.sin(angle), np.full(on_table, TABLE_HEIGHT)]
    )

    which = np.arange(count // 2) % BALLS
    directions = rng.normal(size=(count // 2, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = np.concatenate([table, balls[which] + radii[which, None] * directions])
    return np.ascontiguousarray(rng.permutation(points))


def hundredth(points: FloatArray) -> FloatArray:
    """A box, (2, 3) [m], that holds a hundredth of the points, on the table and off its rim."""
    center = np.array([-0.3, -0.3])
    away = np.abs(points[:, :2] - center).max(axis=1)
    half = float(np.partition(away, len(away) // 100)[len(away) // 100])
    return np.array([[*(center - half), -1.0], [*(center + half), 1.0]])


def random_configurations(robot: pdoik.Robot, count: int, seed: int) -> FloatArray:
    """Uniform within the limits, (count, n) [rad]."""
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.lower, robot.upper, (count, robot.dof))
