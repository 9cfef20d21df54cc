"""Recover joint angles from points.

After Maric et al. 2021: the points are moved onto the base's, by a reflection if that fits
better, since distances do not tell it; then joint after joint is turned so that the next axis's
points come closest to where they were found. Two points that turn about a given axis have their
best angle in closed form (in the public implementation, a root of a polynomial). A tetrahedron of
two neighbouring skew axes that came out mirrored is not seen here: its angles are then wrong.
"""

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.judges.recheck import rotation_about
from bench.ik.methods.distance_geometry.points import BASE, ArmPoints

TURN = 2 * np.pi
NEGLIGIBLE = 1e-12  # lever arms squared that tell no angle [m^2]


def align(Y: FloatArray, base: FloatArray) -> FloatArray:
    """Y moved, turned and if need be reflected so that its base points come onto these, (N, 3)."""
    center, target = Y[list(BASE)].mean(axis=0), base.mean(axis=0)
    U, _, Vt = np.linalg.svd((Y[list(BASE)] - center).T @ (base - target))
    return np.asarray((Y - center) @ (U @ Vt) + target)


def angles(points: ArmPoints, found: FloatArray, otherwise: FloatArray) -> FloatArray:
    """The joint angles that points in the base frame stand for, in (-pi, pi], (n,) [rad].

    The arm's points were found at (N, 3) [m]; joints that no point tells, as the last one, have the
    angles `otherwise`, (n,) [rad].
    """
    theta = np.array(otherwise, dtype=np.float64)
    zero = points.zero
    R, t = np.eye(3), np.zeros(3)  # moves the zero configuration's points of the next axis
    for joint in range(points.n_joints - 1):
        p, q = points.pair(joint)
        following = list(points.pair(joint + 1))
        axis = R @ (zero[q] - zero[p])
        axis /= np.linalg.norm(axis)
        pivot = R @ zero[p] + t
        before = zero[following] @ R.T + t - pivot
        after = found[following] - pivot
        across = before - np.outer(before @ axis, axis)
        sine, cosine = float(np.sum(np.cross(across, after) @ axis)), float(np.sum(across * after))
        if np.hypot(sine, cosine) > NEGLIGIBLE:
            theta[joint] = np.arctan2(sine, cosine)
        turn = rotation_about(axis, theta[joint])
        R, t = turn @ R, turn @ (t - pivot) + pivot
    return theta


def within_turns(theta: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Each angle moved by whole turns to between its limits, or as it is where none is, (n,)."""
    least = theta + TURN * np.ceil((np.where(np.isfinite(lower), lower, theta) - theta) / TURN)
    # Of several turns inside, the one nearest zero keeps room on both sides.
    nearest = theta - TURN * np.round(theta / TURN)
    inside = (nearest >= lower) & (nearest <= upper)
    return np.where(inside, nearest, np.where(least <= upper, least, theta))
