"""A link's collision geometry as a solid: how far points are outside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import cKDTree

from .hulls import FloatArray

_SAMPLES = 20_000  # of the surface; the triangles that the nearest ones lie on give the distance
_NEAREST = 3
_MOST_VOXELS = 300_000
_FINEST_VOXEL = 3e-3  # edge [m]
_FINEST_PATCH = 1e-4  # edge [m]
_ASIDE = np.array([0.3819, 0.2361, 0.1459])
"""Shares of a voxel's edge by which the grid is aside: faces of boxes at round figures would lie
between two layers of voxels, and rounding would decide."""
_REACH = 0.03  # how far beyond the surface the grid extends [m]


def subdivide(triangles: FloatArray, longest: float) -> FloatArray:
    """The same surface in triangles (T, 3, 3) none of whose edges is longer than `longest` [m]."""
    done, rest = [np.empty((0, 3, 3))], triangles
    while len(rest):
        long = np.linalg.norm(np.roll(rest, -1, axis=1) - rest, axis=2).max(axis=1) > longest
        done.append(rest[~long])
        rest = bisect(rest[long])
    return np.concatenate(done)


def bisect(triangles: FloatArray) -> FloatArray:
    """Each triangle cut in two halves through the middle of its longest edge, (2 T, 3, 3)."""
    lengths = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)  # (T, 3)
    order = (lengths.argmax(axis=1)[:, None] + np.arange(3)) % 3
    p, q, r = np.moveaxis(np.take_along_axis(triangles, order[:, :, None], axis=1), 1, 0)
    middle = (p + q) / 2
    return np.concatenate([np.stack([p, middle, r], axis=1), np.stack([middle, q, r], axis=1)])


def areas(triangles: FloatArray) -> FloatArray:
    """Area of each triangle (T, 3, 3), (T,) [m^2]."""
    edges = triangles[:, 1:] - triangles[:, :1]
    return np.asarray(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2)


def spread(triangles: FloatArray, count: int) -> tuple[FloatArray, NDArray[np.int_]]:
    """Points spread evenly over the surface, (count, 3), and the triangles they lie on, (count,).

    Places along the summed areas are equidistant; within the triangles they follow Roberts' R2
    sequence, so that the same input gives the same points.
    """
    sums = np.cumsum(areas(triangles) + 1e-15)  # so that points alone are a surface too
    owners = np.searchsorted(sums, (np.arange(count) + 0.5) / count * sums[-1])
    u, v = np.modf(np.outer([0.7548776662466927, 0.5698402909980532], np.arange(1, count + 1)))[0]
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    p, q, r = np.moveaxis(triangles[owners], 1, 0)
    return p + u[:, None] * (q - p) + v[:, None] * (r - p), owners


@dataclass(frozen=True, slots=True)
class Solid:
    """The surface, and whatever it encloses without a gap that a voxel of the grid would see.

    Orientation and watertightness are not asked of the triangles: a voxel is inside if no path of
    voxels free of surface leads from it to the outside. An open shell has no inside.
    """

    triangles: FloatArray  # (T, 3, 3) [m]
    samples: cKDTree  # of points spread over the surface
    owners: NDArray[np.int_]  # the triangle that each sample lies on
    origin: FloatArray  # (3,), center of the first voxel [m]
    edge: float  # of a voxel [m]
    depth: FloatArray  # (X, Y, Z), voxel center's distance to the surface, < 0 outside [m]

    @classmethod
    def of(cls, triangles: FloatArray) -> Solid:
        """The solid that triangles (T, 3, 3) bound."""
        points, owners = spread(triangles, _SAMPLES)
        corners = triangles.reshape(-1, 3)
        low, high = corners.min(axis=0) - _REACH, corners.max(axis=0) + _REACH
        edge = max(_FINEST_VOXEL, float(np.cbrt(np.prod(high - low) / _MOST_VOXELS)))
        low = low - edge * _ASIDE
        shape = np.ceil((high - low) / edge).astype(int) + 1
        # The path between neighboring voxels' centers crosses the surface less than half an edge
        # from one of these points, hence one of the two voxels holds it.
        dense = subdivide(triangles, 0.85 * edge).reshape(-1, 3)
        index = np.ravel_multi_index(tuple(np.rint((dense - low) / edge).astype(int).T), shape)
        wall, where = np.unique(index, return_inverse=True)
        counts = np.bincount(where)
        means = np.stack([np.bincount(where, dense[:, i]) / counts for i in range(3)], axis=1)
        of_wall = np.full(shape, -1)
        of_wall.flat[wall] = np.arange(len(wall))
        free, _ = ndimage.label(of_wall < 0)
        inside = (free != free[0, 0, 0]) & (of_wall < 0)
        nearest = ndimage.distance_transform_edt(
            of_wall < 0, return_distances=False, return_indices=True
        )
        axes = [low[i] + edge * np.arange(shape[i]) for i in range(3)]
        centers = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        distance = np.linalg.norm(centers - means[of_wall[tuple(nearest)]], axis=-1)
        depth = np.where(inside, distance, -distance)
        return cls(triangles, cKDTree(points), owners, low, edge, depth)

    def landmarks(self, count: int) -> FloatArray:
        """About `count` points of the surface, its corners and edges among them, (N, 3)."""
        longest = max(float(np.sqrt(3 * areas(self.triangles).sum() / count)), _FINEST_PATCH)
        corners = subdivide(self.triangles, longest).reshape(-1, 3)
        _, first = np.unique(np.rint(corners / (longest / 2)), axis=0, return_index=True)
        own = np.unique(self.triangles.reshape(-1, 3), axis=0)
        _, own_first = np.unique(np.rint(own / (longest / 6)), axis=0, return_index=True)
        return np.unique(np.concatenate([corners[first], own[own_first]]), axis=0)

    def depth_at(self, points: FloatArray) -> FloatArray:
        """Depth of points (N, 3) below the surface, < 0 outside; off the grid that of its rim [m].

        Interpolated: good to about a voxel, and of uncertain sign so near the surface.
        """
        at = ((points - self.origin) / self.edge).T
        return np.asarray(ndimage.map_coordinates(self.depth, at, order=1, mode="nearest"))

    def outside(self, points: FloatArray) -> FloatArray:
        """Distance of points (N, 3) from the solid, 0 inside it, (N,) [m].

        Taken to the triangles of the nearest samples: never too small, and hardly ever too large.
        Points less than about a voxel below the surface count as outside.
        """
        nearest = np.asarray(self.samples.query(points, k=_NEAREST)[1])
        distance = np.full(len(points), np.inf)
        for owners in self.owners[nearest].T:
            closest: Any = trimesh.triangles.closest_point(self.triangles[owners], points)  # type: ignore[no-untyped-call]
            distance = np.minimum(distance, np.linalg.norm(points - closest, axis=1))
        at = np.rint((points - self.origin) / self.edge).astype(int)
        on_grid = ((at >= 0) & (at < self.depth.shape)).all(axis=1)
        at = np.clip(at, 0, np.array(self.depth.shape) - 1)
        deep = (self.depth[tuple(at.T)] > 0) & on_grid
        return np.asarray(np.where(deep, 0.0, distance))

    def nearest(self, point: FloatArray) -> FloatArray:
        """The surface's point nearest to one (3,), (3,) [m]."""
        each = np.broadcast_to(point, (len(self.triangles), 3))
        closest: Any = trimesh.triangles.closest_point(self.triangles, each)  # type: ignore[no-untyped-call]
        return np.asarray(closest[np.linalg.norm(closest - point, axis=1).argmin()])

    def inner_points(self) -> tuple[FloatArray, FloatArray]:
        """Centers of the voxels inside, (N, 3), and their depths, (N,) [m]."""
        index = np.argwhere(self.depth > 0)
        return self.origin + self.edge * index, self.depth[tuple(index.T)]
