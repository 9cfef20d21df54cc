"""Spheres and prolate spheroids, and the smallest ones that hold a set of points."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.spatial import ConvexHull, QhullError

FloatArray: TypeAlias = NDArray[np.float64]
Point: TypeAlias = tuple[float, float, float]

MARGIN = 1e-6  # what a hull is larger than the geometry it holds, [m]
_BALL_BONUS = 2e-3  # relative volume a sphere may have more: one distance less per obstacle point
DECIMALS = 9  # of every number in a hull: far below MARGIN, so that rounding never loses a point


class Sphere(NamedTuple):
    """A ball fixed to a link."""

    link: str
    center: Point  # in the link's frame, [m]
    radius: float  # [m]


class Spheroid(NamedTuple):
    """The points whose distances to two foci add up to less than `2 semi_major`."""

    link_a: str
    focus_a: Point  # in link_a's frame, [m]
    link_b: str
    focus_b: Point  # in link_b's frame, [m]
    semi_major: float  # [m]


class Shape(NamedTuple):
    """A spheroid in one frame; a sphere when its foci coincide."""

    focus_a: FloatArray  # (3,)
    focus_b: FloatArray  # (3,)
    semi_major: float

    @property
    def is_ball(self) -> bool:
        return bool(np.array_equal(self.focus_a, self.focus_b))

    @property
    def volume(self) -> float:
        """4/3 pi a (a^2 - c^2), where the foci are 2 c apart, [m^3]."""
        c = float(np.linalg.norm(self.focus_b - self.focus_a)) / 2
        return 4 / 3 * np.pi * self.semi_major * (self.semi_major**2 - c**2)

    def contains(self, points: FloatArray) -> NDArray[np.bool_]:
        """Which of the points (N, 3) lie inside."""
        return half_sum(points, self.focus_a, self.focus_b) < self.semi_major


def half_sum(points: FloatArray, focus_a: FloatArray, focus_b: FloatArray) -> FloatArray:
    """Half the sum of each point's distances to the foci (Eq. link_coll_avoid), (N,) [m]."""
    to_a = np.linalg.norm(points - focus_a, axis=-1)
    to_b = np.linalg.norm(points - focus_b, axis=-1)
    return np.asarray(to_a + to_b) / 2


def tidy_point(point: FloatArray) -> Point:
    """The point rounded to `DECIMALS`, without negative zeros."""
    x, y, z = (round(float(value), DECIMALS) + 0.0 for value in point)
    return (x, y, z)


def around(points: FloatArray, focus_a: FloatArray, focus_b: FloatArray) -> Shape:
    """The smallest spheroid with these foci that holds the points (N, 3), plus `MARGIN`.

    A spheroid is convex, so it holds whatever is spanned by points it holds: for a mesh, the
    maximum over the vertices is the maximum over the surface.
    """
    a, b = np.array(tidy_point(focus_a)), np.array(tidy_point(focus_b))
    return Shape(a, b, round(float(half_sum(points, a, b).max()) + MARGIN, DECIMALS))


def extreme_points(points: FloatArray) -> FloatArray:
    """The vertices of the points' convex hull; all points where that hull is flat."""
    unique = np.unique(points, axis=0)
    try:
        return np.asarray(unique[ConvexHull(unique).vertices], dtype=np.float64)
    except (QhullError, ValueError):
        return unique


def principal_axes(points: FloatArray) -> FloatArray:
    """Principal axes of points (N, 3), the longest first, as rows (3, 3).

    Without BLAS, whose sums depend on how many threads share them: ties would be broken by chance.
    """
    centered = points - points.mean(axis=0)
    _, axes = np.linalg.eigh(np.einsum("ni,nj->ij", centered, centered))
    return np.asarray(axes.T[::-1])


def convex_volume(points: FloatArray) -> float:
    """Volume of the points' convex hull, 0 where it is flat, [m^3]."""
    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0


def smallest_shape(points: FloatArray) -> Shape:
    """A spheroid with free foci, or a sphere, of locally least volume around the points (N, 3)."""
    corners = extreme_points(points)
    origin = (corners.min(axis=0) + corners.max(axis=0)) / 2
    scale = max(float(np.abs(corners - origin).max()), MARGIN)
    unit = (corners - origin) / scale

    def shape_from(half: FloatArray, *, is_ball: bool = False) -> Shape:
        center, half = _descend(unit, half, is_ball=is_ball, tolerance=1e-7)
        return around(corners, origin + scale * (center - half), origin + scale * (center + half))

    axes = principal_axes(unit)
    starts = 0.7 * np.abs(np.einsum("ni,ki->nk", unit, axes)).max(axis=0)[:, None] * axes
    spheroid = min((shape_from(start) for start in starts), key=lambda shape: shape.volume)
    ball = shape_from(np.zeros(3), is_ball=True)
    return ball if ball.volume <= (1 + _BALL_BONUS) * spheroid.volume else spheroid


def _descend(
    points: FloatArray, half: FloatArray, *, is_ball: bool, tolerance: float
) -> tuple[FloatArray, FloatArray]:
    """Least volume over centre and half axis (foci = centre -+ half) by SQP on an active set.

    The epigraph form is smooth: minimise log a + log(a^2 - |half|^2) with a >= half_sum(p) for
    every point p. Only the points that press on the hull enter; violated ones join them.
    """
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    active = np.zeros(len(points), dtype=bool)
    solved = -np.inf
    for _ in range(6):
        sums = half_sum(points, center - half, center + half)
        outside = np.argsort(-sums)[:24]
        outside = outside[sums[outside] > solved + tolerance]
        if not len(outside):
            break
        active[outside] = True
        start = np.concatenate([center, half, [sums.max()]])
        x = _sqp(points[active], start, is_ball=is_ball, tolerance=tolerance)
        center, half, solved = x[:3], x[3:6], float(x[6])
    return center, half


def _sqp(points: FloatArray, start: FloatArray, *, is_ball: bool, tolerance: float) -> FloatArray:
    """SLSQP on x = (centre, half axis, semi-major); a ball's half axis stays where it is."""

    def log_volume(x: FloatArray) -> tuple[float, FloatArray]:
        half, a = x[3:6], x[6]
        b2 = max(a * a - half @ half, 1e-12)
        gradient = np.concatenate([np.zeros(3), -2 * half / b2, [1 / a + 2 * a / b2]])
        return float(np.log(a) + np.log(b2)), gradient

    def slack(x: FloatArray) -> FloatArray:
        return np.asarray(x[6] - half_sum(points, x[:3] - x[3:6], x[:3] + x[3:6]))

    def slack_jacobian(x: FloatArray) -> FloatArray:
        to_a = points - (x[:3] - x[3:6])
        to_b = points - (x[:3] + x[3:6])
        to_a /= np.maximum(np.linalg.norm(to_a, axis=1, keepdims=True), 1e-12)
        to_b /= np.maximum(np.linalg.norm(to_b, axis=1, keepdims=True), 1e-12)
        by_half = np.zeros_like(to_a) if is_ball else (to_b - to_a) / 2
        return np.hstack([(to_a + to_b) / 2, by_half, np.ones((len(points), 1))])

    constraint: Any = {"type": "ineq", "fun": slack, "jac": slack_jacobian}
    result = minimize(
        log_volume,
        start,
        jac=True,
        method="SLSQP",
        bounds=[(-3, 3)] * 6 + [(1e-6, 6)],
        constraints=constraint,
        options={"maxiter": 60, "ftol": tolerance},
    )
    x: FloatArray = np.asarray(result.x, dtype=np.float64)
    return x if np.isfinite(x).all() else start
