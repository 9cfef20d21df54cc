"""Where two solids are nearest to each other, and where a robot is to what it has to keep off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._hulls import PlacedCapsule, PlacedHull, PlacedSpheroid, hull_names, one_hull

from .mesh import shape_mesh
from .pieces import link_pieces
from .surfaces import onto_spheroid, part_distance, part_surface, segment_surface

FloatArray = npt.NDArray[np.float64]
Part = PlacedHull | pdoik.Shape
"""A solid in the base frame: a hull, an obstacle, or what is attached to a link."""

_GOLDEN = (np.sqrt(5) - 1) / 2
_LOOKS = 9  # along a hull's segment
_SPLITS = 32  # of what is between two of them: to 5e-8 of its length
_PROJECTIONS = 200
_SAME_LENGTH = 1e-6  # [m]
_SEEDS = 300  # on the surface of a shape that is neither ball nor capsule


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NearestObstacle:
    """The least of `pdoik.Solver.clearances`, and between which two points it is."""

    obstacle: str  # the shape's name, 'the ball' or 'points'
    part: str  # of the robot: a hull, or what is attached to it
    distance: float  # negative inside [m]
    line: FloatArray | None  # from the part's surface to the obstacle's, (2, 3) [m]


def nearest_obstacle(
    found: Sequence[pdoik.ObstacleClearance],
    robot: pdoik.Robot,
    q: FloatArray,
    points: FloatArray,
    shapes: Sequence[pdoik.Shape],
    ball: int | None = None,
    carried: Sequence[pdoik.Attachment] = (),
) -> NearestObstacle | None:
    """The nearest of them; None where nothing is to keep off anything.

    Args:
        found: What the solver says of q.
        robot: Whose hulls.
        q: (n,).
        points: Those that the solver had, (K, 4) [m].
        shapes: Those that it had.
        ball: Which of the points is the page's ball.
        carried: What is attached to links.
    """
    least = min(found, key=lambda each: each.distance, default=None)
    if least is None or not np.isfinite(least.distance):
        return None
    obstacle: Part
    if least.point is not None:
        obstacle = point_part(points[least.point])
        name = "the ball" if least.point == ball else "points"
    else:
        (obstacle,) = (each for each in shapes if each.name == least.obstacle)
        name = obstacle.name
    part = named_part(least.part, robot, q, carried)
    line = None if part is None else _line_of(least, part, robot, q, obstacle)
    return NearestObstacle(obstacle=name, part=least.part, distance=least.distance, line=line)


def _line_of(
    found: pdoik.ObstacleClearance, part: Part, robot: pdoik.Robot, q: FloatArray, obstacle: Part
) -> FloatArray:
    """Line from the hull, or from the piece of its link that the distance is of."""
    lines = [nearest_points(part, obstacle)]
    if isinstance(part, PlacedCapsule) and _misfit(lines[0], found) > _SAME_LENGTH:
        pieces = link_pieces(robot, q, part.name)
        lines += [nearest_points(piece, obstacle) for piece in pieces]
    return min(lines, key=lambda line: _misfit(line, found))


def _misfit(line: FloatArray, found: pdoik.ObstacleClearance) -> float:
    return abs(float(np.linalg.norm(line[1] - line[0])) - abs(found.distance))


def named_part(
    name: str, robot: pdoik.Robot, q: FloatArray, carried: Sequence[pdoik.Attachment] = ()
) -> Part | None:
    """The part of a robot that results call so: what is attached to a link, or a hull."""
    for each in carried:
        for shape in each.shapes:
            if shape.name == name:
                return placed(shape, robot.fk(q, each.links[0]))
    names = hull_names(robot)
    return one_hull(robot, q, names.index(name)) if name in names else None


def placed(shape: pdoik.Shape, T_base_link: FloatArray) -> pdoik.Shape:
    """A shape in a link's frame, in the base frame."""
    return shape.moved(T_base_link @ shape.T_base_shape)


def point_part(point: FloatArray) -> PlacedSpheroid:
    """An obstacle point and its radius, (4,) [m], as a ball."""
    center = np.asarray(point[:3], dtype=np.float64)
    return PlacedSpheroid(name="", focus_a=center, focus_b=center, semi_major=float(point[3]))


def nearest_points(a: Part, b: Part) -> FloatArray:
    """Line from a's surface to b's, (2, 3) [m]; where parts overlap, the depth of one in the other.

    Of two shapes of which neither is a ball or a capsule it is found by projections in turn, which
    end at the nearest points of convex ones. Of a spheroid that overlaps something it is through
    the place between its foci that is deepest in it.
    """
    for one, other, order in ((a, b, 1), (b, a, -1)):
        segment = _segment(one)
        if segment is not None:
            return _from_segment(*segment, other)[::order]
    for one, other, order in ((a, b, 1), (b, a, -1)):
        if isinstance(one, PlacedSpheroid):
            return _from_spheroid(one, other)[::order]
    assert isinstance(a, pdoik.Shape)
    assert isinstance(b, pdoik.Shape)
    lines = [_from_shape(a, b), _from_shape(b, a)]
    least = min((each for each in lines if each is not None), key=lambda each: each[0])
    return least[1] if least is lines[0] else least[1][::-1]


def _segment(part: Part) -> tuple[FloatArray, FloatArray, float] | None:
    """The ends and the radius of what is a ball or a capsule."""
    if isinstance(part, PlacedCapsule):
        return part.a, part.b, part.radius
    if isinstance(part, PlacedSpheroid):
        if np.linalg.norm(part.focus_b - part.focus_a) < 1e-9:
            return part.focus_a, part.focus_a, part.semi_major
        return None
    if part.kind not in ("sphere", "capsule"):
        return None
    T = np.asarray(part.T_base_shape)
    half = part.size[1] / 2 * T[:3, 2] if part.kind == "capsule" else np.zeros(3)
    return T[:3, 3] - half, T[:3, 3] + half, part.size[0]


def _from_segment(a: FloatArray, b: FloatArray, radius: float, other: Part) -> FloatArray:
    """Line found by golden section where looks along the segment have found the least.

    Between them the signed distance is convex, of a convex solid all along.
    """
    to_other = part_distance(other)

    def distance_at(t: float) -> float:
        return to_other(a + t * (b - a))

    low, high = 0.0, 1.0
    if np.linalg.norm(b - a) > 1e-9:
        looks = np.linspace(0.0, 1.0, _LOOKS)
        least = int(np.argmin([distance_at(t) for t in looks]))
        low, high = looks[max(least - 1, 0)], looks[min(least + 1, _LOOKS - 1)]
        x, y = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_x, at_y = distance_at(x), distance_at(y)
        for _ in range(_SPLITS):
            if at_x <= at_y:
                high, y, at_y = y, x, at_x
                x = high - _GOLDEN * (high - low)
                at_x = distance_at(x)
            else:
                low, x, at_x = x, y, at_y
                y = low + _GOLDEN * (high - low)
                at_y = distance_at(y)
    nearest = min((low, (low + high) / 2, high), key=distance_at)
    center = a + nearest * (b - a)
    distance, place = part_surface(other)(center)
    apart = float(np.linalg.norm(center - place))
    if apart < 1e-9:
        return np.array([place, place])
    if distance > radius:  # what is nearest to a field's place may be elsewhere on the segment
        return np.array([segment_surface(a, b, radius)(place)[1], place])
    outward = np.copysign(1 / apart, distance) * (center - place)
    return np.array([center - radius * outward, place])


def _from_spheroid(hull: PlacedSpheroid, other: Part) -> FloatArray:
    """Line found by projections in turn, which end at the nearest points of convex solids."""
    surface = part_surface(other)
    point = (hull.focus_a + hull.focus_b) / 2
    for _ in range(_PROJECTIONS):
        distance, place = surface(point)
        if distance <= 0 or hull.gap(place[None])[0] <= 0:
            return _out_of_spheroid(hull, other)
        before, point = point, onto_spheroid(hull, place)
        if np.linalg.norm(point - before) < 1e-7:
            break
    return np.array([point, place])


def _out_of_spheroid(hull: PlacedSpheroid, other: Part) -> FloatArray:
    """Line from where a spheroid that overlaps something ends in it, to that thing's surface."""
    center, place = _from_segment(hull.focus_a, hull.focus_b, 0.0, other)
    inward = center - place if part_distance(other)(center) < 0 else place - center
    length = float(np.linalg.norm(inward))
    if length < 1e-9:
        return np.array([place, place])
    low, high = 0.0, 2 * hull.semi_major
    for _ in range(_SPLITS):
        middle = (low + high) / 2
        inside = hull.gap((center + middle / length * inward)[None])[0] < 0
        low, high = (middle, high) if inside else (low, middle)
    return np.array([center + low / length * inward, place])


def _from_shape(a: pdoik.Shape, b: pdoik.Shape) -> tuple[float, FloatArray] | None:
    """The distance, and the line, that the points of a's surface nearest to b lead to."""
    if a.kind == "half_space":
        return None
    to_a, to_b = part_surface(a), part_surface(b)
    seeds = _seeds(a)
    distances = [to_b(point)[0] for point in seeds]
    point = seeds[int(np.argmin(distances))]
    distance, place = to_b(point)
    for _ in range(_PROJECTIONS):
        if distance <= 0:
            break
        near, onto = to_a(place)
        if near <= 0:
            return 0.0, np.array([place, place])
        if np.linalg.norm(onto - point) < 1e-7:
            break
        point = onto
        distance, place = to_b(point)
    return distance, np.array([point, place])


def _seeds(shape: pdoik.Shape) -> FloatArray:
    """Corners of its surface and middles of its triangles, some of them if there are many."""
    mesh, T = shape_mesh(shape)
    chosen = []
    for points in (np.asarray(mesh.vertices), np.asarray(mesh.triangles).mean(axis=1)):
        every = max(1, len(points) // (_SEEDS // 2))
        chosen.append(points[::every])
    return np.asarray(np.concatenate(chosen) @ T[:3, :3].T + T[:3, 3])
