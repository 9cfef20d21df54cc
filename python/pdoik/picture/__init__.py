"""Pictures of solutions: arm, hulls, the points around, where the tip is and should be."""

from __future__ import annotations

import io
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from PIL import Image

from pdoik import Result, Robot
from pdoik._files import write_whole
from pdoik._hulls import PlacedCapsule, PlacedHull, gaps, placed_hulls, skeleton

from .facets import FacetSoup, spheroid_axes
from .view import best_azimuth

__all__ = ["draw_solution"]

FloatArray = npt.NDArray[np.float64]

_HULL, _BONE, _JOINT, _SURFACE = "#6f9fcf", "#2b2f36", "#f28e2b", "#8a8f98"
_GAP_COLORS = LinearSegmentedColormap.from_list("gap", ["#d3151b", "#f59a23", "#e6d47f", "#9fb1bf"])
_FAR = 0.3  # gaps beyond it look alike [m]
_MOST_BALLS = 3000  # of more points each is a dot
_MOST_DOTS = 15000  # shown, of points or surface
_ELEVATION = 20.0  # [deg]


def draw_solution(
    path: str | Path,
    robot: Robot,
    result: Result,
    T_base_tip: FloatArray,
    *,
    cloud: FloatArray | None = None,
    surface: FloatArray | None = None,
    title: str | None = None,
    size: float = 9.0,
    dpi: int = 130,
) -> None:
    """Draw a robot at `result.q` into a PNG file.

    Args:
        path: Where to; an old file there is replaced once the new one is whole.
        robot: The robot; its occupancy is drawn as translucent surfaces, wide hulls around
            capsules faintly.
        result: What the solver or its judge returned.
        T_base_tip: The target, (4, 4).
        cloud: The obstacle points that were solved against, (K, 3) [m], as balls, or dots where
            they are many, coloured by their gap to the nearest hull.
        surface: What they were made from, (N, 3) [m], as faint dots.
        title: The first line; None for the robot's name and the status.
        size: Edge of the picture [inch].
        dpi: Pixels per inch.

    Raises:
        OSError: The file cannot be written.
        ValueError: A cloud has another shape.
    """
    q = np.asarray(result.q, dtype=np.float64)
    cloud, surface = _points(cloud, "cloud"), _points(surface, "surface")
    tip = robot.tip_links[0]
    bones = skeleton(robot, q, tip)
    hulls = placed_hulls(robot, q)
    center, reach = _frame(hulls, bones, cloud, T_base_tip[:3, 3])
    unit = reach / 100  # what line widths are measured in [m]
    near = np.abs(cloud - center).max(axis=1, initial=0) <= reach
    gap = gaps(hulls, cloud)

    solids, frames = FacetSoup(), FacetSoup()
    for hull in hulls:
        if isinstance(hull, PlacedCapsule):
            solids.capsule(hull.a, hull.b, hull.radius, _HULL, alpha=0.24)
        else:
            axes = spheroid_axes(hull.focus_a, hull.focus_b, hull.semi_major)
            alpha = 0.24 if hull.fills else 0.05
            solids.ellipsoid(hull.ends.mean(axis=0), axes, _HULL, alpha=alpha)
    for start, end in pairwise(bones):
        solids.cone(start, end, (1.3 * unit, 1.3 * unit), _BONE)
    solids.balls(bones[:-1], 2.3 * unit, np.tile(to_rgb(_JOINT), (len(bones) - 1, 1)), n=12)
    colors = _GAP_COLORS(np.clip(gap[near] / _FAR, 0, 1))[:, :3]
    dots = near.sum() > _MOST_BALLS
    if not dots:
        solids.balls(cloud[near], 1.5 * unit, colors)
    frames.frame(np.asarray(T_base_tip), 26 * unit, 0.4 * unit)
    frames.frame(robot.fk(q, tip), 14 * unit, 1.0 * unit)

    figure = Figure(figsize=(size, size), facecolor="white")
    canvas = FigureCanvasAgg(figure)
    axes3d = figure.add_axes((0.0, 0.09, 1.0, 0.83), projection="3d", computed_zorder=False)
    assert isinstance(axes3d, Axes3D)
    _set_view(axes3d, center, reach, best_azimuth(bones, cloud[near], _ELEVATION))
    _shadows(axes3d, bones, cloud[near], center[2] - reach)
    if len(surface):
        inside = surface[np.abs(surface - center).max(axis=1) <= reach]
        shown = inside[:: max(1, len(inside) // _MOST_DOTS)]
        axes3d.scatter(*shown.T, s=1.2, c=_SURFACE, alpha=0.4, lw=0, depthshade=False, zorder=2)
    if dots:
        every = max(1, int(near.sum()) // _MOST_DOTS)
        axes3d.scatter(
            *cloud[near][::every].T, s=3, c=colors[::every], lw=0, depthshade=False, zorder=2
        )
    for soup, zorder in ((solids, 3), (frames, 4)):
        facets = Poly3DCollection(soup.corners, facecolors=soup.colors, lw=0, antialiaseds=False)
        facets.set_zorder(zorder)
        axes3d.add_collection3d(facets)
    axes3d.text(*(T_base_tip[:3, 3] + 30 * unit * T_base_tip[:3, 2]), "target", zorder=5, size=9)
    _legend(figure, hulls, cloud, surface, tip)
    _headline(figure, robot, result, title, len(cloud))
    buffer = io.BytesIO()
    canvas.print_figure(buffer, dpi=2 * dpi, format="png")
    write_whole(path, _halved(buffer))


def _points(points: FloatArray | None, name: str) -> FloatArray:
    array = np.empty((0, 3)) if points is None else np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise ValueError(f"{name} has shape {array.shape}, expected (N, 3)")
    return array[:, :3]


def _halved(png: io.BytesIO) -> bytes:
    """A picture at half the size: its edges are smooth, without the seams of smoothed facets."""
    halved = io.BytesIO()
    with Image.open(png) as image:
        size = image.width // 2, image.height // 2
        image.convert("RGB").resize(size, Image.Resampling.BOX).save(halved, format="png")
    return halved.getvalue()


def _frame(
    hulls: list[PlacedHull], bones: FloatArray, cloud: FloatArray, target: FloatArray
) -> tuple[FloatArray, float]:
    """Centre and half edge [m] of a cube around the arm, its target, and obstacles near by."""
    arm = [bones, target[None]]
    for hull in hulls:
        middle = hull.ends.mean(axis=0)
        arm += [middle[None] - hull.extent, middle[None] + hull.extent]
    inner = np.concatenate(arm)
    extent = float(np.ptp(inner, axis=0).max())
    near = cloud[gaps(hulls, cloud) < extent] if hulls else cloud
    corners = np.concatenate([inner, near])
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    return (lower + upper) / 2, float((upper - lower).max()) / 2 * 1.02


def _set_view(axes: Axes3D, center: FloatArray, reach: float, azimuth: float) -> None:
    limits = [(c - reach, c + reach) for c in center]
    axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
    axes.set_box_aspect((1, 1, 1), zoom=1.09)
    axes.set_proj_type("persp", focal_length=1.6)
    axes.view_init(elev=_ELEVATION, azim=azimuth)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_zlabel("z [m]")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((0.965, 0.97, 0.98, 1.0))
        axis._axinfo["grid"].update(color="#d9dde3", linewidth=0.6)
    axes.tick_params(labelsize=8, colors="#555555", pad=1)


def _shadows(axes: Axes3D, bones: FloatArray, cloud: FloatArray, floor: float) -> None:
    """What hangs in the air is hard to place without its shadow."""
    axes.plot(bones[:, 0], bones[:, 1], floor, color="#c3cad3", linewidth=5, zorder=1)
    axes.scatter(
        cloud[:, 0], cloud[:, 1], floor, s=14, c="#dfe3e8", lw=0, depthshade=False, zorder=1
    )


def _legend(
    figure: Figure, hulls: list[PlacedHull], cloud: FloatArray, surface: FloatArray, tip: str
) -> None:
    def dot(color: str, size: float, label: str, alpha: float = 1.0) -> Line2D:
        return Line2D([], [], marker="o", ls="", color=color, ms=size, label=label, alpha=alpha)

    bone = Line2D([], [], color=_BONE, lw=4, marker="o", mfc=_JOINT, mew=0, ms=9)
    bone.set_label("links and joints")
    handles = [bone]
    filled = sum(hull.fills for hull in hulls)
    if hulls:
        handles.append(dot(_HULL, 14, f"{filled} hulls", 0.5))
    if filled < len(hulls):
        handles.append(dot(_HULL, 14, f"{len(hulls) - filled} wide ones around them", 0.15))
    handles.append(Line2D([], [], color="#1f5fd0", lw=4, label=f"{tip} (x red, y green, z blue)"))
    handles.append(Line2D([], [], color="#1f5fd0", lw=1.6, label="its target"))
    if len(cloud):
        handles.append(dot("#f59a23", 7, f"{len(cloud)} obstacle points"))
    if len(surface):
        handles.append(dot(_SURFACE, 2.5, f"the {len(surface)} points they stand for"))
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.01, 0.005), ncols=3, frameon=False,
        fontsize=9, handlelength=1.6, columnspacing=1.4,
    )  # fmt: skip
    if len(cloud) and hulls:
        bar_axes = figure.add_axes((0.715, 0.072, 0.26, 0.013))
        mappable = ScalarMappable(Normalize(0, _FAR), _GAP_COLORS)
        bar = figure.colorbar(mappable, cax=bar_axes, orientation="horizontal", extend="max")
        bar.ax.set_title("gap to the nearest hull [m]", fontsize=9, loc="left", pad=4)
        bar.ax.tick_params(labelsize=8, length=2)


def _headline(
    figure: Figure, robot: Robot, result: Result, title: str | None, n_points: int
) -> None:
    status = result.status.replace("_", " ")
    color = "#1b7f3b" if result.success else "#b3261e"
    first = title or f"{robot.name}: {status}"
    figure.text(0.03, 0.965, first, fontsize=16, weight="bold", color=color, va="center")
    numbers = [
        f"position error {result.position_error:.1e} m",
        f"rotation error {result.rotation_error:.1e} rad",
    ]
    if n_points:
        numbers.append(f"clearance {1e3 * result.clearance:.1f} mm")
    numbers.append(f"{1e3 * result.time:.2f} ms")
    figure.text(0.03, 0.932, "    ".join(numbers), fontsize=10.5, color="#333333", va="center")
