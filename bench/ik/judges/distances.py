"""Distances by their definition, in double precision.

A hull is the set of all points whose mean distance to two foci is at most its semi-major axis A;
one focus makes it a ball. Foci farther apart than 2 A hold nothing.
"""

import numpy as np

from bench.common.arrays import FloatArray

BISECTIONS = 42  # of a quarter turn: its length over 2^42 is 4e-13, of which the square counts


def ellipse_distance(A: FloatArray, B: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Distance of points to the ellipse (A cos t, B sin t), A >= B > 0, x, y >= 0, all (K,) [m].

    Half the squared distance has the slope x A sin t - y B cos t - (A^2 - B^2) sin t cos t. It is
    not positive at t = 0 nor negative at t = pi / 2 and changes sign once between: bisection.
    """
    low, high = np.zeros_like(x), np.full_like(x, np.pi / 2)
    for _ in range(BISECTIONS):
        t = 0.5 * (low + high)
        sine, cosine = np.sin(t), np.cos(t)
        slope = x * A * sine - y * B * cosine - (A - B) * (A + B) * sine * cosine
        below = slope < 0.0
        low, high = np.where(below, t, low), np.where(below, high, t)
    t = 0.5 * (low + high)
    least = np.hypot(x - A * np.cos(t), y - B * np.sin(t))
    # Where the slope is zero at an end too, that end may be the nearest.
    return np.minimum(least, np.minimum(np.hypot(x - A, y), np.hypot(x, y - B)))


def hull_distance(points: FloatArray, a: FloatArray, b: FloatArray, A: FloatArray) -> FloatArray:
    """Distance of points to hulls' surfaces, (K,) [m]: negative inside, infinite to an empty hull.

    Points and foci a and b are (K, 3) each, semi-major axes A (K,).
    """
    half = 0.5 * np.linalg.norm(b - a, axis=1)
    B = np.sqrt(np.maximum((A - half) * (A + half), 0.0))
    axis = (b - a) / np.where(half > 0.0, 2.0 * half, 1.0)[:, None]
    from_centre = points - 0.5 * (a + b)
    along = np.einsum("ki,ki->k", from_centre, axis)
    radial = np.linalg.norm(from_centre - along[:, None] * axis, axis=1)
    ball = half <= 1e-12 * A
    distance = np.linalg.norm(from_centre, axis=1) - A
    rest = ~ball & (half < A)
    along, radial = np.abs(along[rest]), radial[rest]
    gap = ellipse_distance(A[rest], B[rest], along, radial)
    inside = (along / A[rest]) ** 2 + (radial / B[rest]) ** 2 < 1.0
    distance[rest] = np.where(inside, -gap, gap)
    distance[half >= A] = np.inf
    return distance


def to_segment(point: FloatArray, p: FloatArray, q: FloatArray) -> FloatArray:
    """Distance of points (..., 3) to the segments from p to q, (...) [m]."""
    u = q - p
    square = np.einsum("...i,...i", u, u)
    along = np.einsum("...i,...i", point - p, u) / np.where(square > 0.0, square, 1.0)
    return np.linalg.norm(point - p - np.clip(along, 0.0, 1.0)[..., None] * u, axis=-1)
