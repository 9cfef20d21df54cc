"""Targets that lie on surfaces: the tool comes along the inward normal and touches."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from bench.ik.problems.solids import pose

FloatArray = npt.NDArray[np.float64]
TOUCH = ("wrist_3_link", "ee_link", "tool0")  # UR10's tool, which may touch what carries a target


def facing(point: FloatArray, normal: FloatArray) -> FloatArray:
    """A tool's pose at a point, its z against the outward normal, (4, 4).

    Its x axis is the base's x (or y, where the normal is along x), made level with the surface.
    """
    z = -normal / np.linalg.norm(normal)
    along = np.array([1.0, 0, 0]) if abs(z[0]) < 0.9 else np.array([0, 1.0, 0])
    x = along - (along @ z) * z
    x /= np.linalg.norm(x)
    return pose(point, np.column_stack([x, np.cross(z, x), z]))


def allow(*solids: str) -> frozenset[tuple[str, str]]:
    """The tool may touch these."""
    return frozenset((link, solid) for link in TOUCH for solid in solids)
