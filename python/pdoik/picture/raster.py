"""Triangles and points as pixels, the nearest in front: what matplotlib does not do in 3D."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
Project = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Projects points (..., 3) to pixels from the upper left, (..., 2), and distances, (...,)."""

_AT_ONCE = 1_000_000  # pixels


class DepthBuffer:
    """What is nearest in each pixel.

    Args:
        width: In pixels.
        height: In pixels.

    Attributes:
        depth: (H * W,), infinite where there is nothing.
        color: (H * W, 3), from 0 to 1.
    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.depth = np.full(width * height, np.inf, dtype=np.float32)
        self.color = np.ones((width * height, 3), dtype=np.float32)

    def fill(self, project: Project, triangles: FloatArray, colors: FloatArray) -> None:
        """Draw triangles, (T, 3, 3), each in its colour, (T, 3): pixels whose middle is in it."""
        if not len(triangles):
            return
        corners, distances = project(triangles)
        closeness = _Plane.through(corners, 1 / distances)  # linear as seen
        rows = _Rows.of(corners, self.width, self.height)
        for part in rows.parts():
            count = part.end - part.start
            each = np.repeat(part.triangle, count)
            first = np.repeat(part.start - np.cumsum(count) + count, count)
            x, y = first + np.arange(count.sum()), np.repeat(part.y, count)
            near = 1 / closeness.at(each, x, y)
            self._write(np.column_stack([x, y]), near, colors[each])

    def dots(self, project: Project, points: FloatArray, colors: FloatArray, radius: float) -> None:
        """Draw points, (N, 3), each in its colour, (N, 3), as discs of a radius in pixels."""
        pixels, depth = project(points)
        steps = np.arange(-int(radius), int(radius) + 1)
        disc = np.array([(x, y) for x in steps for y in steps if np.hypot(x, y) <= radius])
        places = (np.floor(pixels).astype(np.int64)[:, None] + disc[None]).reshape(-1, 2)
        each = np.repeat(np.arange(len(points)), len(disc))
        seen = ((places >= 0) & (places < [self.width, self.height])).all(axis=1)
        self._write(places[seen], depth[each[seen]], colors[each[seen]])

    def _write(self, pixels: IntArray, depth: FloatArray, colors: FloatArray) -> None:
        """Keep what is nearer than what there is."""
        place, near = pixels[:, 1] * self.width + pixels[:, 0], depth.astype(np.float32)
        np.minimum.at(self.depth, place, near)
        nearest = near == self.depth[place]
        self.color[place[nearest]] = colors[nearest]


def blended(
    solid: DepthBuffer, layers: Sequence[tuple[DepthBuffer, float]]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Solids seen through translucent layers, each with its opacity.

    Returns:
        Colours, (H * W, 3), and opacities, (H * W,), from 0 to 1.
    """
    opacity = np.isfinite(solid.depth).astype(np.float32)
    color = solid.color * opacity[:, None]
    covered = np.zeros(len(opacity), dtype=bool)
    for layer, _ in layers:
        covered |= layer.depth < solid.depth
    seen = np.flatnonzero(covered)
    if len(seen):
        shown, shade = color[seen], opacity[seen]
        depths = np.stack([layer.depth[seen] for layer, _ in layers])
        for rank in np.argsort(-depths, axis=0):  # the farthest first, pixel by pixel
            for k, (layer, alpha) in enumerate(layers):
                at = np.flatnonzero((rank == k) & (depths[k] < solid.depth[seen]))
                shown[at] = alpha * layer.color[seen[at]] + (1 - alpha) * shown[at]
                shade[at] = alpha + (1 - alpha) * shade[at]
        color[seen], opacity[seen] = shown / np.maximum(shade, 1e-6)[:, None], shade
    return color, opacity


def covered(buffers: Sequence[DepthBuffer]) -> npt.NDArray[np.bool_]:
    """The pixels where any of them has something, (H, W)."""
    first = buffers[0]
    there = np.zeros(first.height * first.width, dtype=bool)
    for each in buffers:
        there |= np.isfinite(each.depth)
    return there.reshape(first.height, first.width)


@dataclass(frozen=True, slots=True)
class _Plane:
    """A number that is linear over each triangle."""

    value: FloatArray  # at the origin, (T,)
    slope: FloatArray  # (T, 2)

    @classmethod
    def through(cls, corners: FloatArray, values: FloatArray) -> _Plane:
        """Plane of its values at the corners, (T, 3); flat over what is seen from its edge."""
        (ax, ay), (bx, by) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
        twice = ax * by - ay * bx
        twice = np.where(np.abs(twice) < 1e-9, np.inf, twice)
        a, b = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
        slope = np.column_stack([(a * by - b * ay) / twice, (b * ax - a * bx) / twice])
        return cls(values[:, 0] - (slope * corners[:, 0]).sum(axis=1), slope)

    def at(self, triangle: IntArray, x: IntArray, y: IntArray) -> FloatArray:
        """Value in the middle of pixels, (N,)."""
        slope = self.slope[triangle]
        return self.value[triangle] + slope[:, 0] * (x + 0.5) + slope[:, 1] * (y + 0.5)


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows of pixels that lie in triangles, each from a start to before an end, (R,)."""

    triangle: IntArray
    y: IntArray
    start: IntArray
    end: IntArray

    @classmethod
    def of(cls, corners: FloatArray, width: int, height: int) -> _Rows:
        """Rows of triangles by corners, (T, 3, 2): a pixel's middle decides, of two the upper."""
        low = np.clip(np.ceil(corners[..., 1].min(axis=1) - 0.5), 0, height).astype(np.int64)
        high = np.clip(np.ceil(corners[..., 1].max(axis=1) - 0.5), 0, height).astype(np.int64)
        count = high - low
        triangle = np.repeat(np.arange(len(corners)), count)
        y = np.arange(count.sum()) + np.repeat(low - np.cumsum(count) + count, count)
        middle = y + 0.5
        left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
        for k in range(3):
            a, b = corners[triangle, k], corners[triangle, (k + 1) % 3]
            passes = (a[:, 1] < middle) != (b[:, 1] < middle)
            rise = np.where(passes, b[:, 1] - a[:, 1], 1.0)
            x = a[:, 0] + (middle - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
            left = np.where(passes, np.minimum(left, x), left)
            right = np.where(passes, np.maximum(right, x), right)
        start = np.clip(np.ceil(left - 0.5), 0, width).astype(np.int64)
        end = np.clip(np.ceil(right - 0.5), 0, width).astype(np.int64)
        some = end > start
        return cls(triangle[some], y[some], start[some], end[some])

    def parts(self) -> Iterator[_Rows]:
        """Groups of about so many pixels as are drawn at once."""
        total = np.cumsum(self.end - self.start)
        if not len(total):
            return
        ends = np.searchsorted(total, np.arange(_AT_ONCE, total[-1] + _AT_ONCE, _AT_ONCE), "right")
        for part in np.split(np.arange(len(total)), np.unique(ends)):
            if len(part):
                yield _Rows(self.triangle[part], self.y[part], self.start[part], self.end[part])
