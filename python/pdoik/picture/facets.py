"""Solids as coloured triangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.colors import to_rgb

FloatArray = npt.NDArray[np.float64]
Color = str | tuple[float, float, float]

_LIGHT = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])
_AXES = ("#d62728", "#2ca02c", "#1f5fd0")  # of a frame


class FacetSoup:
    """Triangles with their colours, gathered to be drawn at once."""

    def __init__(self) -> None:
        self._corners: list[FloatArray] = []  # (F, 3, 3) each
        self._colors: list[FloatArray] = []  # (F, 3) each, RGB

    @property
    def corners(self) -> FloatArray:
        """(F, 3, 3) [m]."""
        return np.concatenate([*self._corners, np.empty((0, 3, 3))])

    @property
    def colors(self) -> FloatArray:
        """Colours without light, (F, 3)."""
        return np.concatenate([*self._colors, np.empty((0, 3))])

    def lit(self, eye: FloatArray, ambient: float = 0.45) -> FloatArray:
        """The colours in a light from above, on the sides seen from a place, (F, 3)."""
        corners = self.corners
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
        seen = np.sign(np.einsum("fd,fd->f", normal, eye - corners.mean(axis=1)))
        light = ambient + (1 - ambient) * (0.5 + 0.5 * seen * (normal @ _LIGHT))
        return np.asarray(np.clip(1.12 * self.colors * light[:, None], 0, 1))

    def add(self, corners: FloatArray, rgb: FloatArray) -> None:
        """Add triangles, (F, 3, 3), or quadrilaterals, (F, 4, 3), of one colour or one each."""
        colors = np.broadcast_to(rgb, (len(corners), 3))
        if corners.shape[1] == 4:
            corners = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
            colors = np.concatenate([colors, colors])
        self._corners.append(corners)
        self._colors.append(colors)

    def ellipsoid(self, center: FloatArray, axes: FloatArray, color: Color, n: int = 32) -> None:
        """An ellipsoid; the columns of `axes` (3, 3) are its semi-axes, the first one its pole."""
        sphere = _sphere(n)
        self.add(center + sphere @ axes.T, np.array(to_rgb(color)))

    def balls(self, centers: FloatArray, radius: float, rgb: FloatArray, n: int = 8) -> None:
        """Balls, one colour each."""
        sphere = radius * _sphere(n)  # (F, 4, 3)
        corners = centers[:, None, None, :] + sphere[None]
        self.add(corners.reshape(-1, 4, 3), np.repeat(rgb, len(sphere), axis=0))

    def cone(
        self,
        start: FloatArray,
        end: FloatArray,
        radii: tuple[float, float],
        color: Color,
        n: int = 16,
    ) -> None:
        """A cone or cylinder between two points, open at its ends."""
        length = float(np.linalg.norm(end - start))
        if length < 1e-9:
            return
        side, up = _normals((end - start) / length)
        angle = np.linspace(0, 2 * np.pi, n + 1)
        ring = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up  # (n + 1, 3)
        grid = np.stack([start + radii[0] * ring, end + radii[1] * ring])  # (2, n + 1, 3)
        self.add(_quads(grid), np.array(to_rgb(color)))

    def capsule(
        self, a: FloatArray, b: FloatArray, radius: float, color: Color, n: int = 24
    ) -> None:
        """What lies within a radius of a segment."""
        v = b - a
        length = float(np.linalg.norm(v))
        axis = v / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
        side, up = _normals(axis)
        around = np.linspace(0, 2 * np.pi, n + 1)
        ring = np.cos(around)[:, None] * side + np.sin(around)[:, None] * up  # (n + 1, 3)
        cap = np.linspace(-np.pi / 2, 0, n // 4 + 1)
        along = np.concatenate([radius * np.sin(cap), length - radius * np.sin(cap[::-1])])
        wide = radius * np.concatenate([np.cos(cap), np.cos(cap[::-1])])
        grid = a + along[:, None, None] * axis + wide[:, None, None] * ring
        self.add(_quads(grid), np.array(to_rgb(color)))

    def arrow(self, start: FloatArray, vector: FloatArray, radius: float, color: Color) -> None:
        """An arrow from `start` along `vector`."""
        length = float(np.linalg.norm(vector))
        neck = start + vector * max(0.0, 1 - 5 * radius / length)
        self.cone(start, neck, (radius, radius), color)
        self.cone(neck, start + vector, (2.4 * radius, 0.0), color)

    def frame(self, T: FloatArray, length: float, radius: float) -> None:
        """The axes of a frame: x red, y green, z blue."""
        for axis, color in enumerate(_AXES):
            self.arrow(T[:3, 3], length * T[:3, axis], radius, color)


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
