"""The direction to look from."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

_HIDES = 0.06  # of the arm's extent: how near to the arm, as seen, a point hides it


def best_azimuth(bones: FloatArray, cloud: FloatArray, elevation: float) -> float:
    """The direction [deg] that shows the arm broadly with few obstacle points in front of it.

    Args:
        bones: The arm as a line through points, (K, 3) [m].
        cloud: Points of obstacles, (N, 3) [m].
        elevation: Of the camera [deg].
    """
    arm = _along(bones)
    extent = _extent(bones)
    scores = {}
    for azimuth in (side + turn for side in (-180, -90, 0, 90) for turn in (25, 35, 45, 55, 65)):
        _, right, up = camera(azimuth, elevation)
        breadth = float(np.ptp(arm @ right)) + 0.5 * float(np.ptp(arm @ up))
        scores[azimuth] = breadth / extent - 1.5 * hidden(bones, cloud, azimuth, elevation)
    return float(max(scores, key=lambda azimuth: scores[azimuth]))


def hidden(bones: FloatArray, cloud: FloatArray, azimuth: float, elevation: float) -> float:
    """The share of an arm that has a point of obstacles in front of it; as `best_azimuth` takes."""
    arm = _along(bones)
    toward, right, up = camera(azimuth, elevation)
    offset = cloud[:, None] - arm[None]  # (N, A, 3)
    near = np.hypot(offset @ right, offset @ up) < _HIDES * _extent(bones)
    return float((near & (offset @ toward > 0)).any(axis=0).mean())


def camera(azimuth: float, elevation: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors towards the camera, to its right, and up, of angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    toward = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return toward, right, np.cross(toward, right)


def _along(bones: FloatArray) -> FloatArray:
    t = np.linspace(0, 1, 6)[:, None, None]
    return np.asarray((bones[:-1] + t * np.diff(bones, axis=0)).reshape(-1, 3))


def _extent(bones: FloatArray) -> float:
    return float(np.ptp(bones, axis=0).max()) or 1.0
