"""A robot's moving hulls as coal's shapes, and exact distances from points to them."""

from dataclasses import dataclass
from typing import Any, Self

import coal
import numpy as np

import pdoik
from bench.common.arrays import FloatArray, moved, z_along
from bench.ik.judges.distances import to_segment
from bench.ik.methods.hulls import Hull, hulls_of


@dataclass(frozen=True, slots=True)
class Capsule:
    """The capsule about a spheroid: as thick and as long, fuller at its ends.

    coal knows no ellipsoids together with octrees.
    """

    hull: Hull
    shape: Any  # coal.Capsule, along its z
    half_length: float  # of the axis between the caps' centres [m]

    @classmethod
    def about(cls, hull: Hull) -> Self:
        """The tightest one."""
        half_length = hull.semi_major - hull.semi_minor
        return cls(hull, coal.Capsule(hull.semi_minor, 2 * half_length), half_length)

    def place(self, T_base_link: FloatArray) -> Any:
        """The transform that coal takes."""
        R = T_base_link[:3, :3] @ z_along(self.hull.axis)
        return coal.Transform3s(R, moved(self.hull.center, T_base_link))

    def gap(self, T_base_link: FloatArray, points: FloatArray) -> float:
        """Least distance to a point, negative inside [m]."""
        reach = self.half_length * self.hull.axis
        ends = [moved(self.hull.center + side * reach, T_base_link) for side in (-1, 1)]
        return float(to_segment(points, *ends).min()) - self.hull.semi_minor


def moving_hulls(robot: pdoik.Robot) -> list[Hull]:
    """Those that a joint moves: the only ones that an answer can keep clear of anything."""
    middle = robot.mid_configuration()

    def moves(link: str) -> bool:
        poses = [robot.fk(q, link) for q in (middle, middle + 0.1, middle - 0.2)]
        return any(not np.allclose(poses[0], T) for T in poses[1:])

    moving = set(filter(moves, robot.link_names))
    return [hull for hull in hulls_of(robot) if hull.link in moving]
