"""Robots and solids as pictures, for the pages: a depth buffer of NumPy, no graphics card.

Facets come from the soup that `pdoik.picture` draws with. Each is filled with samples, the nearest
of a pixel is seen, and a shadow falls on the floor.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

import pdoik
from pdoik._hulls import skeleton
from pdoik.picture.facets import FacetSoup
from pdoik.picture.raster import DepthBuffer, Project, blended
from pdoik.solids import shape_mesh

FloatArray = npt.NDArray[np.float64]

LINKS = ("#d9dde2", "#8fb3d9")  # of links in turn
TOOL, SOLID, GOAL, FAINT = "#f28e2b", "#b9a58a", "#1b7f3b", "#9aa0a8"
FINE = 2  # samples of a pixel's edge
AMBIENT = 0.5
FLOOR, SHADE = np.array([0.955, 0.96, 0.968]), 0.13
GRID = 0.1  # of the lines on the floor [m]


def add_robot(soup: FacetSoup, robot: pdoik.Robot, q: FloatArray, color: str | None = None) -> None:
    """A robot's capsules; tubes between its joints if it has none."""
    links = robot.link_names
    for link, a, b, radius, *_ in robot.occupancy.capsules:
        T = robot.fk(q, link)
        ends = [T[:3, :3] @ np.array(each) + T[:3, 3] for each in (a, b)]
        soup.capsule(*ends, radius, color or LINKS[links.index(link) % 2], n=20)
    if not len(robot.occupancy):
        joints = skeleton(robot, q, robot.tip_links[0])
        for k, (a, b) in enumerate(pairwise(joints)):
            soup.capsule(a, b, 0.026, color or LINKS[k % 2])
        soup.balls(joints[1:-1], 0.036, np.tile(to_rgb(TOOL), (len(joints) - 2, 1)), n=20)


def add_box(soup: FacetSoup, size: Iterable[float], T: FloatArray, color: str) -> None:
    """A box."""
    add_shape(soup, pdoik.Shape.box("box", list(size), T), color)


def add_shape(
    soup: FacetSoup, shape: pdoik.Shape, color: str, T_base: FloatArray | None = None
) -> None:
    """A solid, in the base frame or in one that a link carries it in."""
    placed = shape if T_base is None else shape.moved(T_base @ shape.T_base_shape)
    mesh, T = shape_mesh(placed)
    soup.add(mesh.triangles @ T[:3, :3].T + T[:3, 3], np.array(to_rgb(color)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Looks at a place from a direction, in perspective."""

    center: tuple[float, float, float]  # [m]
    width: float  # of what is seen there [m]
    azimuth: float  # [deg]
    elevation: float = 18.0  # [deg]
    size: tuple[int, int] = (620, 480)  # [px]

    @property
    def toward(self) -> FloatArray:
        """The direction of the eye from the centre."""
        a, e = np.radians([self.azimuth, self.elevation])
        return np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])

    def lit(self, soup: FacetSoup) -> FloatArray:
        """The colours of facets, (F, 3), on the side that is seen."""
        eye = np.array(self.center) + 3.0 * self.width * self.toward
        return soup.lit(eye, AMBIENT)

    def project(self, points: FloatArray, fine: int = 1) -> tuple[FloatArray, FloatArray]:
        """Pixels, (..., 2), and distance from the eye, (...,), of points (..., 3)."""
        toward, a = self.toward, np.radians(self.azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        away = 3.0 * self.width
        offset = points - np.array(self.center)
        depth = away - offset @ toward
        scale = fine * self.size[0] / self.width * away / depth
        x = fine * self.size[0] / 2 + scale * (offset @ right)
        y = fine * self.size[1] / 2 - scale * (offset @ np.cross(toward, right))
        return np.stack([x, y], axis=-1), depth

    def buffer(self) -> DepthBuffer:
        """An empty one, fine."""
        return DepthBuffer(FINE * self.size[0], FINE * self.size[1])

    @property
    def finely(self) -> Project:
        """Pixels of such a buffer."""
        return lambda points: self.project(points, FINE)


class Scene3D:
    """What a picture shows: solids, ghosts that one sees through, and marks over them."""

    def __init__(self, camera: Camera, floor: float | None = 0.0) -> None:
        self.camera, self.floor = camera, floor
        self.solids = FacetSoup()
        self.frames = FacetSoup()  # without a shadow
        self._ghosts: list[tuple[FacetSoup, float]] = []

    def ghost(self, alpha: float) -> FacetSoup:
        """A soup to be drawn as one translucent body."""
        soup = FacetSoup()
        self._ghosts.append((soup, alpha))
        return soup

    def image(self) -> FloatArray:
        """(H, W, 3), from 0 to 1."""
        camera = self.camera
        buffer = self._floor()
        for soup in (self.solids, self.frames):
            buffer.fill(camera.finely, soup.corners, camera.lit(soup))
        layers = []
        for soup, alpha in self._ghosts:
            layer = camera.buffer()
            layer.fill(camera.finely, soup.corners, camera.lit(soup))
            layers.append((layer, alpha))
        color, opacity = blended(buffer, layers)
        color = opacity[:, None] * color + (1 - opacity[:, None])  # before white
        width, height = camera.size
        return np.asarray(color.reshape(height, FINE, width, FINE, 3).mean(axis=(1, 3)))

    def _floor(self) -> DepthBuffer:
        camera = self.camera
        buffer = camera.buffer()
        if self.floor is None:
            return buffer
        reach = 0.8 * camera.width
        x, y = camera.center[:2]
        ground = FacetSoup()
        T = np.eye(4)
        T[:3, 3] = x, y, self.floor - 0.006
        add_box(ground, (2 * reach, 2 * reach, 0.01), T, "white")
        white = np.tile(FLOOR, (len(ground.corners), 1))
        buffer.fill(camera.finely, ground.corners, white)
        lines = np.arange(np.ceil((x - reach) / GRID), (x + reach) / GRID) * GRID
        across = np.arange(np.ceil((y - reach) / GRID), (y + reach) / GRID) * GRID
        strips = [(k - 1.5e-3, y - reach, k + 1.5e-3, y + reach) for k in lines]
        strips += [(x - reach, k - 1.5e-3, x + reach, k + 1.5e-3) for k in across]
        flat = np.array([[(a, b), (c, b), (c, d), (a, d)] for a, b, c, d in strips])
        flat = np.concatenate([flat, np.full((*flat.shape[:2], 1), self.floor)], axis=2)
        grid = FacetSoup()
        grid.add(flat, FLOOR - 0.07)
        buffer.fill(camera.finely, grid.corners, grid.colors)
        fallen = self.solids.corners.copy()
        height = fallen[..., 2] - self.floor
        fallen[..., :2] -= height[..., None] * np.array([0.35, -0.45]) / 0.82 * 0.5
        fallen[..., 2] = self.floor + 1e-3
        shadow = camera.buffer()
        shadow.fill(camera.finely, fallen, np.zeros((len(fallen), 3)))
        buffer.color[np.isfinite(shadow.depth) & np.isfinite(buffer.depth)] -= SHADE
        return buffer

    def show(self, axes: Axes, title: str = "") -> None:
        """Put the picture into a panel without ticks."""
        axes.imshow(self.image(), interpolation="antialiased")
        axes.set_axis_off()
        axes.set_xlim(0, self.camera.size[0])
        axes.set_ylim(self.camera.size[1], 0)
        axes.set_title(title, fontsize=10, color="#333333")

    def label(
        self, axes: Axes, at: FloatArray, text: str, shift: tuple[float, float] = (30, -30)
    ) -> None:
        """Text beside a place, with a thin line to it."""
        place, _ = self.camera.project(np.asarray(at))
        axes.annotate(
            text,
            tuple(place),
            tuple(place + shift),
            fontsize=9,
            color="#222222",
            ha="left" if shift[0] >= 0 else "right",
            va="center",
            arrowprops={"arrowstyle": "-", "color": "#555555", "lw": 0.7},
        )

    def line(self, axes: Axes, points: Iterable[FloatArray], **style: object) -> None:
        """A line over all that is drawn."""
        pixels, _ = self.camera.project(np.array(list(points)))
        axes.plot(*pixels.T, **style)


def panels(count: int, columns: int, camera: Camera, inches: float) -> tuple[Figure, list[Axes]]:
    """A figure of pictures beside one another, each `inches` wide."""
    rows = -(-count // columns)
    height = inches * camera.size[1] / camera.size[0] + 0.28
    figure = Figure(figsize=(columns * inches, rows * height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.02, h_pad=0.02, wspace=0.0, hspace=0.0)  # type: ignore[union-attr, call-arg]
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for each in axes[count:]:
        each.set_axis_off()
    return figure, list(axes[:count])


def save(figure: Figure, path: Path) -> None:
    """As a small PNG: 256 colours are enough."""
    figure.savefig(path, dpi=110, facecolor="white", bbox_inches="tight", pad_inches=0.04)
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(256, method=Image.Quantize.MAXCOVERAGE)
    small.save(path, optimize=True)
