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

FloatArray = npt.NDArray[np.float64]

LINKS = ("#d9dde2", "#8fb3d9")  # of links in turn
TOOL, SOLID, GOAL, FAINT = "#f28e2b", "#b9a58a", "#1b7f3b", "#9aa0a8"
FINE = 2  # samples of a pixel's edge
SUN = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])
AMBIENT = 0.5
FLOOR, SHADE = np.array([0.955, 0.96, 0.968]), 0.13
GRID = 0.1  # of the lines on the floor [m]


class Soup(FacetSoup):
    """Facets with their colours as they are: what side of one is lit, the camera knows."""

    def add(
        self, corners: FloatArray, rgb: FloatArray, alpha: float, ambient: float = AMBIENT
    ) -> None:
        """Add facets, (F, 4, 3); `rgb` is one colour or one per facet."""
        colors = np.broadcast_to(rgb, (len(corners), 3))
        self._corners.append(corners)
        self._colors.append(np.column_stack([colors, np.full(len(corners), alpha)]))


def add_robot(soup: FacetSoup, robot: pdoik.Robot, q: FloatArray, color: str | None = None) -> None:
    """A robot's capsules; tubes between its joints if it has none."""
    links = robot.link_names
    for link, a, b, radius, *_ in robot.occupancy.capsules:
        T = robot.fk(q, link)
        ends = [T[:3, :3] @ np.array(each) + T[:3, 3] for each in (a, b)]
        soup.capsule(*ends, radius, color or LINKS[links.index(link) % 2], 1.0, n=20)
    if not len(robot.occupancy):
        joints = skeleton(robot, q, robot.tip_links[0])
        for k, (a, b) in enumerate(pairwise(joints)):
            soup.capsule(a, b, 0.026, color or LINKS[k % 2], 1.0)
        soup.balls(joints[1:-1], 0.036, np.tile(to_rgb(TOOL), (len(joints) - 2, 1)), n=20)


def add_box(
    soup: FacetSoup, size: Iterable[float], T: FloatArray, color: str, piece: float = 0.05
) -> None:
    """A box, its faces in pieces."""
    half = np.array(list(size)) / 2
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1.0, 1.0):
            steps = [np.linspace(-half[k], half[k], int(2 * half[k] / piece) + 2) for k in (u, v)]
            grid = np.empty((len(steps[0]), len(steps[1]), 3))
            grid[..., axis] = side * half[axis]
            grid[..., u], grid[..., v] = np.meshgrid(*steps, indexing="ij")
            grid = grid if side > 0 else grid[:, ::-1]
            grid = grid @ T[:3, :3].T + T[:3, 3]
            corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
            soup.add(np.stack(corners, axis=2).reshape(-1, 4, 3), np.array(to_rgb(color)), 1.0)


def add_shape(
    soup: FacetSoup, shape: pdoik.Shape, color: str, T_base: FloatArray | None = None
) -> None:
    """A solid, in the base frame or in one that a link carries it in."""
    T = shape.T_base_shape if T_base is None else T_base @ shape.T_base_shape
    if shape.kind == "box":
        add_box(soup, shape.size, T, color)
    elif shape.kind == "cylinder":
        radius, length = shape.size
        ends = [T[:3, 3] + side * length / 2 * T[:3, 2] for side in (-1.0, 1.0)]
        soup.cone(*ends, (radius, radius), color, n=40)
        for end, side in zip(ends, (-1.0, 1.0), strict=True):
            soup.cone(end, end + side * 1e-4 * T[:3, 2], (radius, 0.0), color, n=40)
    elif shape.kind == "capsule":
        radius, length = shape.size
        ends = [T[:3, 3] + side * length / 2 * T[:3, 2] for side in (-1.0, 1.0)]
        soup.capsule(*ends, radius, color, 1.0, n=20)
    elif shape.kind == "sphere":
        soup.balls(T[None, :3, 3], shape.size[0], np.array([to_rgb(color)]), n=40)
    else:
        raise ValueError(f"no picture of a {shape.kind}")


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
        corners, colors = soup.corners, soup.colors[:, :3]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
        eye = np.array(self.center) + 3.0 * self.width * self.toward
        seen = np.einsum("fd,fd->f", normal, eye - corners.mean(axis=1))
        light = AMBIENT + (1 - AMBIENT) * (0.5 + 0.5 * np.sign(seen) * (normal @ SUN))
        return np.asarray(np.clip(1.12 * colors * light[:, None], 0, 1))

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


@dataclass(slots=True)
class _Buffer:
    depth: FloatArray  # (H * W,)
    color: FloatArray  # (H * W, 3)

    @classmethod
    def of(cls, camera: Camera) -> _Buffer:
        count = FINE**2 * camera.size[0] * camera.size[1]
        return cls(np.full(count, np.inf), np.ones((count, 3)))

    def fill(self, camera: Camera, corners: FloatArray, colors: FloatArray) -> None:
        """Draw facets, (F, 4, 3), in their colours, (F, 3)."""
        pixels, _ = camera.project(corners, FINE)
        edges = np.abs(pixels - np.roll(pixels, 1, axis=1)).max(axis=(1, 2))
        counts = 3 * np.ceil(np.clip(1.3 * edges + 1, 2, 300) / 3).astype(int)
        for count in np.unique(counts):
            chosen = np.flatnonzero(counts == count)
            for part in np.array_split(chosen, 1 + len(chosen) * count**2 // 2_000_000):
                self._fill(camera, corners[part], colors[part], int(count))

    def _fill(self, camera: Camera, corners: FloatArray, colors: FloatArray, count: int) -> None:
        s = np.linspace(0, 1, count)
        u, v = (each.ravel()[:, None] for each in np.meshgrid(s, s))
        share = np.hstack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])  # (S, 4)
        points = np.einsum("sk,fkd->fsd", share, corners)
        pixels, depth = camera.project(points, FINE)
        x, y = np.floor(pixels).astype(int).reshape(-1, 2).T
        width, height = FINE * camera.size[0], FINE * camera.size[1]
        seen = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        place, near = (y * width + x)[seen], depth.ravel()[seen]
        rgb = np.repeat(np.arange(len(corners)), count**2)[seen]
        order = np.argsort(-near, kind="stable")  # the nearest is written last
        place, near, rgb = place[order], near[order], rgb[order]
        nearest = np.full(len(self.depth), -1)
        nearest[place] = np.arange(len(place))
        at = np.flatnonzero(nearest >= 0)
        at = at[near[nearest[at]] < self.depth[at]]
        self.depth[at], self.color[at] = near[nearest[at]], colors[rgb[nearest[at]]]


class Scene3D:
    """What a picture shows: solids, ghosts that one sees through, and marks over them."""

    def __init__(self, camera: Camera, floor: float | None = 0.0) -> None:
        self.camera, self.floor = camera, floor
        self.solids = Soup()
        self.frames = Soup()  # without a shadow
        self._ghosts: list[tuple[FacetSoup, float]] = []

    def ghost(self, alpha: float) -> FacetSoup:
        """A soup to be drawn as one translucent body."""
        soup = Soup()
        self._ghosts.append((soup, alpha))
        return soup

    def image(self) -> FloatArray:
        """(H, W, 3), from 0 to 1."""
        buffer = _Buffer.of(self.camera)
        floor = self._floor()
        buffer.depth[:], buffer.color[:] = floor.depth, floor.color
        for soup in (self.solids, self.frames):
            buffer.fill(self.camera, soup.corners, self.camera.lit(soup))
        for soup, alpha in self._ghosts:
            layer = _Buffer.of(self.camera)
            layer.fill(self.camera, soup.corners, self.camera.lit(soup))
            seen = layer.depth < buffer.depth
            buffer.color[seen] = alpha * layer.color[seen] + (1 - alpha) * buffer.color[seen]
        width, height = self.camera.size
        return buffer.color.reshape(height, FINE, width, FINE, 3).mean(axis=(1, 3))

    def _floor(self) -> _Buffer:
        buffer = _Buffer.of(self.camera)
        if self.floor is None:
            return buffer
        reach = 0.8 * self.camera.width
        x, y = self.camera.center[:2]
        ground = Soup()
        T = np.eye(4)
        T[:3, 3] = x, y, self.floor - 0.006
        add_box(ground, (2 * reach, 2 * reach, 0.01), T, "white", piece=0.1)
        buffer.fill(self.camera, ground.corners, np.tile(FLOOR, (len(ground.corners), 1)))
        lines = np.arange(np.ceil((x - reach) / GRID), (x + reach) / GRID) * GRID
        across = np.arange(np.ceil((y - reach) / GRID), (y + reach) / GRID) * GRID
        strips = [(k - 1e-3, y - reach, k + 1e-3, y + reach) for k in lines]
        strips += [(x - reach, k - 1e-3, x + reach, k + 1e-3) for k in across]
        flat = np.array([[(a, b), (c, b), (c, d), (a, d)] for a, b, c, d in strips])
        flat = np.concatenate([flat, np.full((*flat.shape[:2], 1), self.floor)], axis=2)
        pieces = np.linspace(0, 1, 31)
        long = np.concatenate([_cut(flat, a, b) for a, b in pairwise(pieces)])
        buffer.fill(self.camera, long, np.tile(FLOOR - 0.07, (len(long), 1)))
        fallen = self.solids.corners.copy()
        height = fallen[..., 2] - self.floor
        fallen[..., :2] -= height[..., None] * np.array([0.35, -0.45]) / 0.82 * 0.5
        fallen[..., 2] = self.floor + 1e-3
        shadow = _Buffer.of(self.camera)
        shadow.fill(self.camera, fallen, np.zeros((len(fallen), 3)))
        ground_seen = np.isfinite(shadow.depth) & np.isfinite(buffer.depth)
        buffer.color[ground_seen] -= SHADE
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


def _cut(strips: FloatArray, a: float, b: float) -> FloatArray:
    """The part of long strips, (N, 4, 3), from one share of their length to another."""
    first, second = strips[:, 1] - strips[:, 0], strips[:, 3] - strips[:, 0]
    along_first = (np.linalg.norm(first, axis=1) > np.linalg.norm(second, axis=1))[:, None]
    along = np.where(along_first, first, second)
    side = np.where(along_first, second, first)
    start, end = strips[:, 0] + a * along, strips[:, 0] + b * along
    return np.stack([start, end, end + side, start + side], axis=1)


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
