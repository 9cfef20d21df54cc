"""The obstacle points of a solve, and the cloud they stand for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.clouds import load_cloud

from .messages import fail, misuse_fails, warn

FloatArray = npt.NDArray[np.float64]

_FARTHEST_LIKELY = 100.0  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacles:
    """A cloud as its file has it, and as the solver gets it."""

    file: Path
    leaf: float  # [m], 0 for every point
    surface: FloatArray  # (N, 3), [m]
    cloud: FloatArray  # (K, 3), or (K, 4) with a radius each, [m]


def load_obstacles(file: Path, leaf: float, radii: bool) -> Obstacles:
    """Read a cloud and downsample it; leaves with status 2 when that cannot be done.

    Args:
        file: Of points.
        leaf: Edge of the cells [m]; 0 keeps every point.
        radii: Give the points that are kept radii that cover those that are not.
    """
    if not leaf >= 0:
        fail(f"--leaf: expected metres, at least 0, got {leaf}")
    with misuse_fails():
        surface = load_cloud(file)
    farthest = float(np.abs(surface).max())
    if farthest > _FARTHEST_LIKELY:
        warn(f"{file} has coordinates up to {farthest:.0f} m: are they millimetres?")
    with misuse_fails(f"--leaf {leaf:g}"):
        cloud = pdoik.voxel_downsample(surface, leaf, radii) if leaf > 0 else surface
    return Obstacles(file=file, leaf=leaf, surface=surface, cloud=cloud)
