"""A robot's surroundings: boxes and balls, as points for the solver and as shapes for the judge."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import coal
import numpy as np

import pdoik
from bench.ik.scenes.primitives import Ball, box, sample_surface
from bench.sim2real.frame.arm import Array

LEAF = 0.015  # of the cloud that the solver gets [m]
POINTS_PER_AREA = 30_000.0  # before the grid thins them [1/m^2]
SHAPES = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """An upright box, or a ball."""

    center: Array  # (3,) [m]
    edges: Array  # (3,) [m]; of a ball its diameter, three times
    ball: bool

    def points(self, rng: np.random.Generator) -> Array:
        """Points sampled on its surface, (N, 3) [m]."""
        patches = (Ball(radius=0.5 * self.edges[0]),) if self.ball else box(*self.edges)
        count = int(POINTS_PER_AREA * sum(patch.area for patch in patches))
        return np.asarray(self.center + sample_surface(patches, count, rng))

    def body(self) -> tuple[Any, Any]:
        """The same for coal: geometry and place."""
        geometry = coal.Sphere(0.5 * self.edges[0]) if self.ball else coal.Box(*self.edges)
        return geometry, coal.Transform3s(np.eye(3), self.center)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """The shapes, and the cloud that stands for them."""

    shapes: tuple[Shape, ...]
    cloud: Array  # (N, 3) [m]


def random_cell(robot: pdoik.Robot, home: Array, rng: np.random.Generator) -> Cell:
    """Shapes before the robot, none within 6 cm of it at home."""
    judge, shapes, clouds = pdoik.Solver(robot), [], []
    T_home = robot.fk(home)
    while len(shapes) < SHAPES:
        angle, distance = rng.uniform(-1.3, 1.3), rng.uniform(0.4, 0.75)
        ball = bool(rng.random() < 0.4)
        edges = np.full(3, rng.uniform(0.1, 0.2)) if ball else rng.uniform(0.06, 0.25, 3)
        center = np.array([distance * np.cos(angle), distance * np.sin(angle), 0.0])
        center[2] = rng.uniform(0.0, 0.75)
        shape = Shape(center=center, edges=edges, ball=ball)
        points = pdoik.voxel_downsample(shape.points(rng), LEAF)
        if judge.judge(T_home, home, obstacles=points).clearance > 0.06:
            shapes.append(shape)
            clouds.append(points)
    return Cell(shapes=tuple(shapes), cloud=np.concatenate(clouds))


class Clearance:
    """Least distance of an arm's hulls from the shapes themselves, by coal.

    The hulls are those of `pdoik`'s Panda, which hold every link's mesh; the places of the links
    come from whoever asks, here from the true machine.
    """

    def __init__(self, occupancy: pdoik.Occupancy, cell: Cell) -> None:
        self._hulls = [_ellipsoid(*spheroid) for spheroid in occupancy.spheroids]
        self._bodies = [shape.body() for shape in cell.shapes]

    def __call__(self, links: Mapping[str, Array]) -> float:
        """Distance of links at these poses (4, 4) in the base; negative on penetration [m]."""
        request, least = coal.DistanceRequest(), np.inf
        for link, geometry, T_link_hull in self._hulls:
            T = links[link] @ T_link_hull
            place = coal.Transform3s(T[:3, :3], T[:3, 3])
            for body, at in self._bodies:
                result = coal.DistanceResult()
                coal.distance(geometry, place, body, at, request, result)
                least = min(least, float(result.min_distance))
        return least


def _ellipsoid(
    link: str, focus: tuple[float, ...], other: str, far: tuple[float, ...], semi_major: float
) -> tuple[str, Any, Array]:
    """A prolate spheroid of one link, long along its own z."""
    if link != other:
        raise ValueError(f"hull of {link} and {other}: expected both foci on one link")
    a, b = np.array(focus), np.array(far)
    half = 0.5 * float(np.linalg.norm(b - a))
    semi_minor = float(np.sqrt(semi_major**2 - half**2))
    z = (b - a) / (2.0 * half)
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.column_stack([x, np.cross(z, x), z]), 0.5 * (a + b)
    return link, coal.Ellipsoid(semi_minor, semi_minor, semi_major), T
