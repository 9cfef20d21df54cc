"""Where the robot is nearest to an obstacle, and to a limit of a joint."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._hulls import PlacedCapsule, PlacedSpheroid, one_hull

from .surfaces import Surface, ball_surface, shape_surface

FloatArray = npt.NDArray[np.float64]

_HULL = re.compile(r"\((sphere|spheroid|capsule) (\d+)\)")
_GOLDEN = (np.sqrt(5) - 1) / 2
_LOOKS = 9  # along a hull's segment
_SPLITS = 32  # of what is between two of them: to 5e-8 of its length
_PROJECTIONS = 200


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NearestObstacle:
    """The least of `pdoik.Solver.clearances`, and between which two points it is."""

    obstacle: str  # the shape's name, 'the ball' or 'points'
    part: str  # of the robot: a hull
    distance: float  # negative inside [m]
    line: FloatArray | None  # from the hull's surface to the obstacle's, (2, 3) [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class NearestLimit:
    """The joint that has the least share of its range left on one side."""

    joint: int
    side: str  # "lower" or "upper"
    distance: float  # negative beyond it [rad] or [m]
    share: float  # of the range


def nearest_obstacle(
    found: Sequence[pdoik.ObstacleClearance],
    robot: pdoik.Robot,
    q: FloatArray,
    points: FloatArray,
    shapes: Sequence[pdoik.Shape],
    ball: int | None = None,
) -> NearestObstacle | None:
    """The nearest of them; None where nothing is to keep off anything.

    Args:
        found: What the solver says of q.
        robot: Whose hulls.
        q: (n,).
        points: Those that the solver had, (K, 4) [m].
        shapes: Those that it had.
        ball: Which of the points is the page's ball.
    """
    least = min(found, key=lambda each: each.distance, default=None)
    if least is None or not np.isfinite(least.distance):
        return None
    if least.point is not None:
        surface = ball_surface(points[least.point, :3], float(points[least.point, 3]))
        name = "the ball" if least.point == ball else "points"
    else:
        (shape,) = (each for each in shapes if each.name == least.obstacle)
        surface, name = shape_surface(shape), shape.name
    named = _HULL.search(least.part)
    line = None
    if named is not None:
        line = _line(one_hull(robot, q, named[1], int(named[2])), surface)
    return NearestObstacle(obstacle=name, part=least.part, distance=least.distance, line=line)


def nearest_limit(robot: pdoik.Robot, q: FloatArray) -> NearestLimit | None:
    """None where no joint has limits."""
    lower, upper = np.asarray(robot.lower), np.asarray(robot.upper)
    width = upper - lower
    limited = np.isfinite(width) & (width > 0)
    if not limited.any():
        return None
    left = np.full(len(q), np.inf)
    left[limited] = (np.minimum(q - lower, upper - q)[limited]) / width[limited]
    joint = int(left.argmin())
    below, above = float(q[joint] - lower[joint]), float(upper[joint] - q[joint])
    return NearestLimit(
        joint=joint,
        side="lower" if below < above else "upper",
        distance=min(below, above),
        share=float(left[joint]),
    )


def limit_text(limit: NearestLimit, robot: pdoik.Robot) -> str:
    """'panda_joint4, 3.1° from its upper end, 1 % of the range'."""
    if robot.joint_types[limit.joint] == "prismatic":
        amount = f"{1e3 * limit.distance:.1f} mm"
    else:
        amount = f"{np.degrees(limit.distance):.1f}°"
    share = f"{100 * limit.share:.0f} % of the range"
    return f"{robot.joint_names[limit.joint]}, {amount} from its {limit.side} end, {share}"


def _line(hull: PlacedCapsule | PlacedSpheroid, surface: Surface) -> FloatArray | None:
    """Between the nearest points of a hull and an obstacle; of spheroids only where apart."""
    if isinstance(hull, PlacedCapsule):
        return _from_segment(hull.a, hull.b, hull.radius, surface)
    if np.linalg.norm(hull.focus_b - hull.focus_a) < 1e-9:
        return _from_segment(hull.focus_a, hull.focus_a, hull.semi_major, surface)
    return _from_spheroid(hull, surface)


def _from_segment(a: FloatArray, b: FloatArray, radius: float, surface: Surface) -> FloatArray:
    """By golden section where looks along the segment have found the least.

    Between them the signed distance is convex, of a convex solid all along.
    """
    low, high = 0.0, 1.0
    if np.linalg.norm(b - a) > 1e-9:
        looks = np.linspace(0.0, 1.0, _LOOKS)
        least = int(np.argmin([surface(a + t * (b - a))[0] for t in looks]))
        low, high = looks[max(least - 1, 0)], looks[min(least + 1, _LOOKS - 1)]
        x, y = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_x, at_y = (surface(a + t * (b - a))[0] for t in (x, y))
        for _ in range(_SPLITS):
            if at_x <= at_y:
                high, y, at_y = y, x, at_x
                x = high - _GOLDEN * (high - low)
                at_x = surface(a + x * (b - a))[0]
            else:
                low, x, at_x = x, y, at_y
                y = low + _GOLDEN * (high - low)
                at_y = surface(a + y * (b - a))[0]
    nearest = min((low, (low + high) / 2, high), key=lambda t: surface(a + t * (b - a))[0])
    center = a + nearest * (b - a)
    distance, place = surface(center)
    if abs(distance) < 1e-9:
        return np.array([place, place])
    outward = (center - place) / distance
    return np.array([center - radius * outward, place])


def _from_spheroid(hull: PlacedSpheroid, surface: Surface) -> FloatArray | None:
    """By projections in turn, which end at the nearest points of convex solids that are apart."""
    point = (hull.focus_a + hull.focus_b) / 2
    for _ in range(_PROJECTIONS):
        distance, place = surface(point)
        if distance <= 0 or hull.gap(place[None])[0] <= 0:
            return None
        before, point = point, _onto_spheroid(hull, place)
        if np.linalg.norm(point - before) < 1e-7:
            break
    return np.array([point, place])


def _onto_spheroid(hull: PlacedSpheroid, point: FloatArray) -> FloatArray:
    """The nearest point of a spheroid to one outside of it."""
    center = (hull.focus_a + hull.focus_b) / 2
    half = (hull.focus_b - hull.focus_a) / 2
    c = float(np.linalg.norm(half))
    axis = half / c
    z = float((point - center) @ axis)
    out = point - center - z * axis
    r = float(np.linalg.norm(out))
    major, minor = hull.semi_major**2, hull.semi_major**2 - c**2
    low, high = -minor, hull.semi_major * float(np.hypot(z, r))
    for _ in range(60):  # (a z / (t + a^2))^2 + (b r / (t + b^2))^2 = 1 falls with t
        t = (low + high) / 2
        inside = major * (z / (t + major)) ** 2 + minor * (r / (t + minor)) ** 2 < 1
        low, high = (low, t) if inside else (t, high)
    return np.asarray(center + major * z / (high + major) * axis + minor / (high + minor) * out)
