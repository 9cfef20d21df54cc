"""A robot's moving hulls as coal's shapes, and exact distances from points to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import coal
import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.methods.hulls import Hull, hulls_of

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Capsule:
    """The capsule about a spheroid: as thick and as long, fuller at its ends.

    coal knows no ellipsoids beside octrees.
    """

    hull: Hull
    shape: Any  # coal.Capsule, along its z
    half_length: float  # of the axis between the caps' centres [m]

    @classmethod
    def about(cls, hull: Hull) -> Capsule:
        """The tightest one."""
        half_length = hull.semi_major - hull.semi_minor
        return cls(
            hull=hull, shape=coal.Capsule(hull.semi_minor, 2 * half_length), half_length=half_length
        )

    def ends(self, T_base_link: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The caps' centres in the base frame."""
        R, t = T_base_link[:3, :3], T_base_link[:3, 3]
        center = R @ self.hull.center + t
        reach = self.half_length * (R @ self.hull.axis)
        return center - reach, center + reach

    def place(self, T_base_link: FloatArray) -> Any:
        """The transform that coal takes."""
        R, t = T_base_link[:3, :3], T_base_link[:3, 3]
        return coal.Transform3s(R @ _frame(self.hull.axis), R @ self.hull.center + t)

    def gap(self, T_base_link: FloatArray, points: FloatArray) -> float:
        """Least distance to a point, negative inside [m]."""
        a, b = self.ends(T_base_link)
        along = b - a
        length = max(float(along @ along), 1e-30)
        share = np.clip((points - a) @ along / length, 0.0, 1.0)
        away = np.linalg.norm(points - a - share[:, None] * along, axis=1)
        return float(away.min()) - self.hull.semi_minor


def moving_hulls(robot: pdoik.Robot) -> list[Hull]:
    """Those that a joint moves: the only ones that an answer can keep clear of anything."""
    moved = {
        link: any(
            not np.allclose(robot.fk(robot.mid_configuration(), link), robot.fk(q, link))
            for q in (robot.mid_configuration() + 0.1, robot.mid_configuration() - 0.2)
        )
        for link in robot.link_names
    }
    return [hull for hull in hulls_of(robot) if moved[hull.link]]


def _frame(axis: FloatArray) -> FloatArray:
    """A rotation whose z is the axis, (3, 3)."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
