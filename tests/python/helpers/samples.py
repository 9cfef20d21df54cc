"""Robots with hulls, random configurations, targets and clouds."""

import numpy as np
from numpy.typing import NDArray

import pdoik

Array = NDArray[np.float64]


def with_hulls(robot: pdoik.Robot) -> pdoik.Robot:
    """The robot; if it has no hulls, with spheroids along its links and a ball at its tip."""
    if len(robot.occupancy) > 0:
        return robot
    q = robot.mid_configuration()
    spheroids = []
    for a, b in zip(robot.link_names, robot.link_names[1:], strict=False):
        length = np.linalg.norm(robot.fk(q, a)[:3, 3] - robot.fk(q, b)[:3, 3])
        spheroids.append((a, (0, 0, 0), b, (0, 0, 0), 0.5 * length + 0.03))
    robot.occupancy = pdoik.Occupancy(
        spheres=[(robot.tip_links[0], (0, 0, 0), 0.05)], spheroids=spheroids
    )
    return robot


def random_configuration(robot: pdoik.Robot, rng: np.random.Generator) -> Array:
    """Uniform inside the limits, or inside one turn."""
    return rng.uniform(np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi))


def reachable_targets(robot: pdoik.Robot, rng: np.random.Generator, count: int) -> Array:
    """Poses of the tip, shape (count, 4, 4)."""
    return np.stack([robot.fk(random_configuration(robot, rng)) for _ in range(count)])


def box_of_points(rng: np.random.Generator, count: int, columns: int = 3) -> Array:
    """Points around an arm's workspace, but not in its foot; a fourth column holds radii."""
    points = rng.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.1], (4 * count, 3))
    points = points[np.hypot(points[:, 0], points[:, 1]) > 0.35][:count]
    if columns == 3:
        return points
    return np.hstack([points, rng.uniform(0.0, 0.04, (len(points), 1))])


def with_capsules(robot: pdoik.Robot) -> pdoik.Robot:
    """The robot with capsules within its last two hulls, and one where it had no hull.

    Of an arm whose hulls are spheroids, each on one link.
    """
    occupancy = robot.occupancy
    *_, (before, p, _, q, before_size), (last, a, _, b, last_size) = occupancy.spheroids
    robot.occupancy = pdoik.Occupancy(
        spheres=occupancy.spheres,
        spheroids=occupancy.spheroids,
        capsules=[
            (before, p, q, 0.3 * before_size),
            (last, a, b, 0.5 * last_size),
            (last, a, a, 0.3 * last_size),
            (robot.tip_links[0], (0.0, 0.0, 0.05), (0.0, 0.1, 0.1), 0.02),
        ],
    )
    return robot
