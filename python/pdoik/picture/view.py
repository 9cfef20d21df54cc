"""From where to look."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def best_azimuth(bones: FloatArray, cloud: FloatArray, elevation: float) -> float:
    """The direction [deg] that shows the arm broadly with few obstacle points in front of it.

    Args:
        bones: The arm as a line through points, (K, 3) [m].
        cloud: Obstacle points, (N, 3) [m].
        elevation: Of the camera [deg].
    """
    t = np.linspace(0, 1, 6)[:, None, None]
    arm = (bones[:-1] + t * np.diff(bones, axis=0)).reshape(-1, 3)
    extent = float(np.ptp(bones, axis=0).max()) or 1.0
    scores = {}
    for azimuth in (side + turn for side in (-180, -90, 0, 90) for turn in (25, 35, 45, 55, 65)):
        toward, right, up = _camera(np.radians(azimuth), np.radians(elevation))
        breadth = float(np.ptp(arm @ right)) + 0.5 * float(np.ptp(arm @ up))
        offset = cloud[:, None] - arm[None]  # (N, A, 3)
        beside = np.hypot(offset @ right, offset @ up) < 0.06 * extent
        hidden = float((beside & (offset @ toward > 0)).any(axis=0).mean())  # fraction of the arm
        scores[azimuth] = breadth / extent - 1.5 * hidden
    return float(max(scores, key=lambda azimuth: scores[azimuth]))


def _camera(azimuth: float, elevation: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors towards the camera, to its right, and up."""
    ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
    toward = np.array([ca * ce, sa * ce, se])
    right = np.array([-sa, ca, 0.0])
    return toward, right, np.cross(toward, right)
