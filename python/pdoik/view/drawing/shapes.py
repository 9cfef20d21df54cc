"""Hulls, links and points as arrays that a page draws in one go."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import pdoik
from pdoik._hulls import PlacedCapsule, PlacedHull, PlacedSpheroid, gaps

FloatArray = npt.NDArray[np.float64]
ByteArray = npt.NDArray[np.uint8]

# Colours of a gap between a point and the nearest hull, from touching to far.
_GAPS = np.array([0.0, 0.06, 0.12, 0.25])  # [m]
_GAP_COLORS = np.array([[211, 21, 27], [245, 140, 25], [222, 196, 90], [72, 98, 128]])


def wxyz_of(R: npt.ArrayLike) -> FloatArray:
    """Unit quaternions, real part first, of rotations (..., 3, 3)."""
    xyzw = Rotation.from_matrix(np.asarray(R, dtype=np.float64)).as_quat()
    return np.asarray(xyzw[..., [3, 0, 1, 2]], dtype=np.float64)


def pose_of(wxyz: npt.ArrayLike, position: npt.ArrayLike) -> FloatArray:
    """The 4x4 matrix of a unit quaternion, real part first, and a position."""
    w, x, y, z = np.asarray(wxyz, dtype=np.float64)
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
    T[:3, 3] = np.asarray(position, dtype=np.float64)
    return T


def spheroid_instances(
    hulls: Sequence[PlacedSpheroid],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Quaternions (H, 4), centres (H, 3) and semi-axes (H, 3) [m]; the first axis is the pole."""
    a = np.array([hull.focus_a for hull in hulls]).reshape(-1, 3)
    b = np.array([hull.focus_b for hull in hulls]).reshape(-1, 3)
    major = np.array([hull.semi_major for hull in hulls])
    half = np.linalg.norm(b - a, axis=1) / 2
    minor = np.sqrt(np.maximum(major**2 - half**2, 0.0))
    wxyz = turns_of_x((b - a) / np.maximum(2 * half, 1e-12)[:, None])
    return wxyz, (a + b) / 2, np.column_stack([major, minor, minor])


def capsule_instances(
    hulls: Sequence[PlacedCapsule],
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Quaternions (C, 4) that turn x along the segments, their ends (C, 2, 3), lengths, radii (C,).

    Lengths in metres.
    """
    ends = np.array([hull.ends for hull in hulls]).reshape(-1, 2, 3)
    vectors = ends[:, 1] - ends[:, 0]
    lengths = np.linalg.norm(vectors, axis=1)
    wxyz = turns_of_x(vectors / np.maximum(lengths, 1e-12)[:, None])
    return wxyz, ends, lengths, np.array([hull.radius for hull in hulls])


def turns_of_x(directions: FloatArray) -> FloatArray:
    """Quaternions (N, 4) that turn the x axis into unit vectors (N, 3); zero ones do not turn."""
    x, y, z = directions.T
    wxyz = np.column_stack([1 + x, np.zeros_like(x), -z, y])
    wxyz[x < -1 + 1e-9] = (0, 0, 0, 1)
    return np.asarray(wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True), dtype=np.float64)


def segments(origins: Sequence[FloatArray]) -> FloatArray:
    """Lines from each origin (3,) to the next, (K - 1, 2, 3) [m]."""
    pairs = list(pairwise(origins))
    return np.array(pairs).reshape(-1, 2, 3)


def moved_shape(shape: pdoik.Shape, T_base_shape: FloatArray) -> pdoik.Shape:
    """The same solid elsewhere.

    Raises:
        ValueError: It is a half-space.
    """
    if shape.kind == "half_space":
        raise ValueError(f"{shape.name}: a {shape.kind} cannot be moved")
    return shape.moved(T_base_shape)


def gap_colors(hulls: list[PlacedHull], obstacles: FloatArray) -> ByteArray:
    """A colour for each obstacle (K, 4) that shows its gap to the nearest hull, (K, 3)."""
    return room_colors(gaps(hulls, obstacles[:, :3]) - obstacles[:, 3])


def room_colors(room: FloatArray) -> ByteArray:
    """A colour for each distance (K,) from red at 0 to blue at 0.25 m and more, (K, 3)."""
    shown = np.clip(room, _GAPS[0], _GAPS[-1])
    return np.stack([np.interp(shown, _GAPS, c) for c in _GAP_COLORS.T], axis=1).astype(np.uint8)
