"""Solids as small coloured facets: matplotlib sorts facets by depth only within one collection."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

FloatArray = npt.NDArray[np.float64]
Color = str | tuple[float, float, float]

_LIGHT = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])


class FacetSoup:
    """Quadrilaterals with shaded colours, gathered to be drawn as one collection."""

    def __init__(self) -> None:
        self._corners: list[FloatArray] = []  # (F, 4, 3) each
        self._colors: list[FloatArray] = []  # (F, 4) each, RGBA

    @property
    def corners(self) -> FloatArray:
        return np.concatenate([*self._corners, np.empty((0, 4, 3))])

    @property
    def colors(self) -> FloatArray:
        return np.concatenate([*self._colors, np.empty((0, 4))])

    def add(
        self, corners: FloatArray, rgb: FloatArray, alpha: float, ambient: float = 0.45
    ) -> None:
        """Add facets, (F, 4, 3), lit from above; `rgb` is one colour or one per facet."""
        across = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
        normal = np.cross(*across)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
        light = ambient + (1 - ambient) * (0.5 + 0.5 * normal @ _LIGHT)
        shaded = np.clip(np.broadcast_to(rgb, (len(corners), 3)) * light[:, None] * 1.12, 0, 1)
        self._corners.append(corners)
        self._colors.append(np.column_stack([shaded, np.full(len(corners), alpha)]))

    def ellipsoid(
        self, center: FloatArray, axes: FloatArray, color: Color, alpha: float, n: int = 20
    ) -> None:
        """An ellipsoid; the columns of `axes` (3, 3) are its semi-axes, the first one its pole."""
        sphere = _sphere(n)
        self.add(center + sphere @ axes.T, np.array(to_rgb(color)), alpha)

    def balls(self, centers: FloatArray, radius: float, rgb: FloatArray, n: int = 8) -> None:
        """Opaque balls, one colour each."""
        sphere = radius * _sphere(n)  # (F, 4, 3)
        corners = centers[:, None, None, :] + sphere[None]
        self.add(corners.reshape(-1, 4, 3), np.repeat(rgb, len(sphere), axis=0), 1.0)

    def cone(
        self,
        start: FloatArray,
        end: FloatArray,
        radii: tuple[float, float],
        color: Color,
        alpha: float = 1.0,
        *,
        piece: float = 0.03,
        n: int = 12,
    ) -> None:
        """A cone or cylinder between two points, cut into pieces short enough to be sorted."""
        length = float(np.linalg.norm(end - start))
        if length < 1e-9:
            return
        side, up = _normals((end - start) / length)
        angle = np.linspace(0, 2 * np.pi, n + 1)
        ring = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up  # (n + 1, 3)
        t = np.linspace(0, 1, max(2, int(np.ceil(length / piece)) + 1))[:, None, None]
        radius = radii[0] + t * (radii[1] - radii[0])
        grid = start + t * (end - start) + radius * ring  # (pieces + 1, n + 1, 3)
        self.add(_quads(grid), np.array(to_rgb(color)), alpha)

    def capsule(
        self, a: FloatArray, b: FloatArray, radius: float, color: Color, alpha: float, n: int = 16
    ) -> None:
        """What lies within a radius of a segment, its tube cut into pieces as a cone's."""
        v = b - a
        length = float(np.linalg.norm(v))
        axis = v / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
        side, up = _normals(axis)
        around = np.linspace(0, 2 * np.pi, n + 1)
        ring = np.cos(around)[:, None] * side + np.sin(around)[:, None] * up  # (n + 1, 3)
        cap = np.linspace(-np.pi / 2, 0, n // 4 + 1)
        pieces = max(1, int(np.ceil(length / 0.03)))
        tube = np.linspace(0, length, pieces + 1)[1:-1]
        along = np.concatenate([radius * np.sin(cap), tube, length - radius * np.sin(cap[::-1])])
        wide = radius * np.concatenate([np.cos(cap), np.ones(len(tube)), np.cos(cap[::-1])])
        grid = a + along[:, None, None] * axis + wide[:, None, None] * ring
        self.add(_quads(grid), np.array(to_rgb(color)), alpha)

    def arrow(
        self, start: FloatArray, vector: FloatArray, radius: float, color: Color, alpha: float = 1.0
    ) -> None:
        """An arrow from `start` along `vector`."""
        length = float(np.linalg.norm(vector))
        neck = start + vector * max(0.0, 1 - 5 * radius / length)
        self.cone(start, neck, (radius, radius), color, alpha)
        self.cone(neck, start + vector, (2.4 * radius, 0.0), color, alpha, piece=0.02)

    def frame(self, T: FloatArray, length: float, radius: float, alpha: float = 1.0) -> None:
        """The axes of a frame: x red, y green, z blue."""
        for axis, color in enumerate(("#d62728", "#2ca02c", "#1f5fd0")):
            self.arrow(T[:3, 3], length * T[:3, axis], radius, color, alpha)


def spheroid_axes(focus_a: FloatArray, focus_b: FloatArray, semi_major: float) -> FloatArray:
    """Semi-axes of the prolate spheroid with these foci, as columns (3, 3) [m]."""
    half = (focus_b - focus_a) / 2
    c = float(np.linalg.norm(half))
    major = half / c if c > 1e-12 else np.array([0.0, 0.0, 1.0])
    semi_minor = np.sqrt(max(semi_major**2 - c**2, 0.0))
    side, up = _normals(major)
    return np.column_stack([semi_major * major, semi_minor * side, semi_minor * up])


def _sphere(n: int) -> FloatArray:
    """A unit sphere of n / 2 by n quadrilaterals about its first axis, (F, 4, 3)."""
    polar = np.linspace(0, np.pi, n // 2 + 1)[:, None]
    around = np.linspace(0, 2 * np.pi, n + 1)[None, :]
    return _quads(
        np.stack(
            [
                np.cos(polar) * np.ones_like(around),
                np.sin(polar) * np.cos(around),
                np.sin(polar) * np.sin(around),
            ],
            axis=-1,
        )
    )


def _quads(grid: FloatArray) -> FloatArray:
    """The cells of a grid of points (R, C, 3), corners in turn so that normals point outwards."""
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    return np.stack(corners, axis=2).reshape(-1, 4, 3)


def _normals(direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors that make a right-handed triad with a unit vector."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    side = np.cross(direction, helper)
    side /= np.linalg.norm(side)
    return side, np.cross(direction, side)
