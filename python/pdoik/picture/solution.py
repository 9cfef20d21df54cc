"""A picture of one solution."""

from __future__ import annotations

import io
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

import pdoik
from pdoik._files import write_whole
from pdoik._hulls import PlacedCapsule, PlacedHull

from .contents import Contents, contents_of
from .cube import Cube, in_pieces, shape_triangles
from .facets import FacetSoup, spheroid_axes
from .labels import Labels
from .marks import Mark, mark_of
from .raster import DepthBuffer, covered
from .stage import FINE, Stage
from .style import (
    BONE,
    FAILS,
    FAR,
    GAP_COLORS,
    HELD,
    HULL,
    JOINT,
    NEAR,
    SHAPE,
    SHAPE_FAILS,
    SURFACE,
)
from .view import best_azimuth, camera, hidden
from .words import headline, legend

FloatArray = npt.NDArray[np.float64]

_MOST_BALLS = 3000  # of more points each is a dot
_MOST_DOTS = 15000  # shown, of points or surface
_MOST_NAMES = 12  # of shapes
_ELEVATION = 20.0  # [deg]
_PIECE = 0.06  # of the cube's half edge: how finely it is looked at what a surface hides
_MOST_MIDDLES = 3000
_HIDDEN = 0.12  # share of the arm that a surface may hide before it is seen through
_ROBOT, _ROBOT_FAILING, _FAILING, _SEEN_THROUGH = 0.6, 0.35, 0.85, 0.4  # opacities


def draw_solution(
    path: str | Path,
    solver: pdoik.Solver,
    result: pdoik.Result,
    T_base_tip: npt.ArrayLike | None = None,
    obstacles: Any = None,
    *,
    surface: npt.ArrayLike | None = None,
    title: str | None = None,
    size: float = 9.0,
    dpi: int = 130,
) -> None:
    """Draw a robot at `result.q` into a PNG file, among its obstacles.

    A line leads from the robot, or from what it holds, to the nearest obstacle. Where the result
    fails by a clearance, the two things that are too near are red.

    Args:
        path: Where to; an old file there is replaced once the new one is whole.
        solver: That gave the result: its robot is drawn, in hulls that are seen through, and what
            it carries.
        result: What the solver or its judge returned.
        T_base_tip: The target, (4, 4); None to draw none.
        obstacles: That it was asked with, in any of the forms that `solve` takes. Points are balls,
            or dots where they are many, coloured by their gap to the nearest hull; half-spaces and
            what is much larger than the robot end at the edge of the picture. Half-spaces, and
            what would hide much of the robot, are seen through.
        surface: What points were made from, (N, 3) [m], as faint dots.
        title: The first line; None for the robot's name and the status.
        size: Edge of the picture [inch].
        dpi: Pixels per inch.

    Raises:
        OSError: The file cannot be written.
        TypeError: It is no solver.
        ValueError: Something has another shape than it should.
    """
    if not isinstance(solver, pdoik.Solver):
        kind = type(solver).__name__
        raise TypeError(
            f"solver: expected a pdoik.Solver, got {kind}; of a robot pdoik.Solver(robot)"
        )
    contents = contents_of(solver, result, T_base_tip, obstacles, surface)
    mark = mark_of(solver, result, contents)
    cube = contents.cube()
    surfaces = {each.name: shape_triangles(each, cube) for each in contents.shapes}
    middles = {name: _middles(each, cube) for name, each in surfaces.items()}
    near = contents.points[cube.holds(contents.points[:, :3]), :3]
    in_the_way = np.concatenate([near[:: 1 + len(near) // _MOST_BALLS], *middles.values()])
    in_the_way = in_the_way[:: 1 + len(in_the_way) // _MOST_MIDDLES]
    azimuth = best_azimuth(contents.bones, in_the_way, _ELEVATION)
    seen_through = {
        shape.name
        for shape in contents.shapes
        if shape.kind == "half_space"
        or hidden(contents.bones, middles[shape.name], azimuth, _ELEVATION) > _HIDDEN
    }

    stage = Stage(size, dpi, cube, azimuth, _ELEVATION)
    _shadows(stage, contents, near, cube)
    legend(stage.figure, contents, mark)
    headline(stage.figure, contents, result, title)
    eye = cube.center + 6 * cube.reach * camera(azimuth, _ELEVATION)[0]
    solid, layers = stage.buffer(), []  # the robot is the first layer
    _fill(stage, solid, _solids(contents, mark, cube, surfaces, seen_through), eye)
    _draw_points(stage, solid, contents, cube, eye)
    for soup, opacity in _layers(contents, mark, surfaces, seen_through):
        layers.append((stage.buffer(), opacity))
        _fill(stage, layers[-1][0], soup, eye)
    labels = Labels(stage.width, stage.height, FINE * dpi, covered([solid, layers[0][0]]))
    _label(labels, stage, solver, result, contents, mark, surfaces)
    buffer = io.BytesIO()
    stage.image(solid, layers, labels.figure).save(buffer, format="png")
    write_whole(path, buffer.getvalue())


def _middles(triangles: FloatArray, cube: Cube) -> FloatArray:
    """Points all over a surface, (N, 3) [m]."""
    middles = in_pieces(triangles, _PIECE * cube.reach).mean(axis=1)
    return np.asarray(middles[:: 1 + len(middles) // _MOST_MIDDLES])


def _solids(
    contents: Contents,
    mark: Mark | None,
    cube: Cube,
    surfaces: dict[str, FloatArray],
    seen_through: set[str],
) -> FacetSoup:
    """What hides what is behind it."""
    soup, unit = FacetSoup(), cube.reach / 100  # what line widths are measured in [m]
    bones, too_near = contents.bones, _too_near(mark)
    for start, end in pairwise(bones):
        soup.cone(start, end, (1.3 * unit, 1.3 * unit), BONE)
    soup.balls(bones[:-1], 2.3 * unit, np.tile(to_rgb(JOINT), (len(bones) - 1, 1)), n=24)
    for name, triangles in surfaces.items():
        if name not in seen_through:
            soup.add(triangles, np.array(to_rgb(SHAPE_FAILS if name in too_near else SHAPE)))
    for shape in contents.held:
        color = FAILS if shape.name in too_near else HELD
        soup.add(shape_triangles(shape, cube), np.array(to_rgb(color)))
    if contents.target is not None:
        soup.frame(contents.target, 26 * unit, 0.4 * unit)
    soup.frame(contents.T_base_tool, 14 * unit, 1.0 * unit)
    return soup


def _layers(
    contents: Contents, mark: Mark | None, surfaces: dict[str, FloatArray], seen_through: set[str]
) -> list[tuple[FacetSoup, float]]:
    """What is seen through, the robot first, and how opaque it is."""
    robot, failing, walls = FacetSoup(), FacetSoup(), FacetSoup()
    too_near = _too_near(mark)
    for number, hull in enumerate(contents.hulls):
        if mark is not None and number in mark.hulls:
            _add_hull(failing, hull, FAILS)
        elif hull.fills:
            _add_hull(robot, hull, HULL)
    for name in sorted(seen_through):
        walls.add(surfaces[name], np.array(to_rgb(SHAPE_FAILS if name in too_near else SHAPE)))
    others = [(failing, _FAILING), (walls, _SEEN_THROUGH)]
    opacity = _ROBOT_FAILING if len(failing.corners) else _ROBOT  # what fails may be inside
    return [(robot, opacity), *(each for each in others if len(each[0].corners))]


def _too_near(mark: Mark | None) -> frozenset[str]:
    return frozenset() if mark is None else mark.names


def _add_hull(soup: FacetSoup, hull: PlacedHull, color: str) -> None:
    if isinstance(hull, PlacedCapsule):
        soup.capsule(hull.a, hull.b, hull.radius, color)
    else:
        axes = spheroid_axes(hull.focus_a, hull.focus_b, hull.semi_major)
        soup.ellipsoid(hull.ends.mean(axis=0), axes, color)


def _fill(stage: Stage, buffer: DepthBuffer, soup: FacetSoup, eye: FloatArray) -> None:
    buffer.fill(stage.project, soup.corners, soup.lit(eye))


def _draw_points(
    stage: Stage, solid: DepthBuffer, contents: Contents, cube: Cube, eye: FloatArray
) -> None:
    """Balls, or dots where there are many, coloured by their gap; and what they stand for."""
    inside = cube.holds(contents.points[:, :3])
    points, gap = contents.points[inside, :3], contents.gap()[inside]
    colors = GAP_COLORS(np.clip(gap / FAR, 0, 1))[:, :3]
    pixel = stage.figure.dpi / 72  # of a point
    if len(points) <= _MOST_BALLS:
        balls = FacetSoup()
        balls.balls(points, 1.5 * cube.reach / 100, colors)
        _fill(stage, solid, balls, eye)
    else:
        every = 1 + len(points) // _MOST_DOTS
        solid.dots(stage.project, points[::every], colors[::every], 0.9 * pixel)
    surface = contents.surface[cube.holds(contents.surface)]
    surface = surface[:: 1 + len(surface) // _MOST_DOTS]
    gray = np.tile(to_rgb(SURFACE), (len(surface), 1))
    solid.dots(stage.project, surface, gray, 0.5 * pixel)


def _label(
    labels: Labels,
    stage: Stage,
    solver: pdoik.Solver,
    result: pdoik.Result,
    contents: Contents,
    mark: Mark | None,
    surfaces: dict[str, FloatArray],
) -> None:
    """The mark, the target, and the names of shapes."""

    def at(points: FloatArray) -> FloatArray:
        return stage.project(points)[0]

    target = contents.target
    if target is not None:
        missed = result.position_error > solver.options.position_tolerance
        if missed and not result.success:
            ends = np.array([contents.T_base_tool[:3, 3], target[:3, 3]])
            labels.line(at(ends), FAILS, 1.6, ":")
    if mark is not None and mark.line is not None:
        color = FAILS if mark.fails else NEAR
        labels.line(at(mark.line), color, 2.2)
        labels.dots(at(mark.line), color, 5.0)
        labels.note(at(mark.line).mean(axis=0), mark.text, color, 9.0)
    if target is not None:
        tip = target[:3, 3] + 0.3 * stage.cube.reach * target[:3, 2]
        labels.text(at(tip), "target", "black", 9.0)
    there = {name: each for name, each in surfaces.items() if len(each)}
    for name, triangles in there.items() if len(there) <= _MOST_NAMES else ():
        points = triangles.reshape(-1, 3)
        low, high = points.min(axis=0), points.max(axis=0)
        top = np.array([*(low + high)[:2] / 2, high[2]])
        labels.text(at(top), name, "#4a4f57", 8.0)


def _shadows(stage: Stage, contents: Contents, points: FloatArray, cube: Cube) -> None:
    """What hangs in the air is hard to place without its shadow."""
    floor, axes, bones = _floor(contents, cube), stage.axes, contents.bones
    axes.plot(bones[:, 0], bones[:, 1], floor, color="#b4bcc6", linewidth=5, zorder=1)
    axes.scatter(
        points[:, 0], points[:, 1], floor, s=14, c="#dfe3e8", lw=0, depthshade=False, zorder=1
    )


def _floor(contents: Contents, cube: Cube) -> float:
    """The height of the highest level half-space below the arm, or of the cube's bottom [m]."""
    planes = [each.T_base_shape for each in contents.shapes if each.kind == "half_space"]
    heights = [float(T[2, 3]) for T in planes if T[2, 2] > 1 - 1e-6]
    lowest = float(contents.bones[1:, 2].min())
    return max([float(cube.center[2]) - cube.reach, *(each for each in heights if each <= lowest)])
