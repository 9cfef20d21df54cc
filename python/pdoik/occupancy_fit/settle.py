"""Radii with which capsules hold a solid, proven cell by cell, and no larger than that takes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .hulls import DECIMALS, MARGIN, FloatArray
from .segments import Capsules, to_segments
from .solid import Solid, areas, bisect, subdivide

_COARSE = 6e-3  # edges of patches at first [m]
_FINE, _FINE_INSIDE = 0.2e-3, 2e-3  # edges of patches and cubes where cutting ends [m]
_MOST_PATCHES = 30_000  # at first
_CHUNK = 400_000  # entries of a matrix of corners by capsules
_SHRINK_ROUNDS = 4


def settle(solid: Solid, capsules: Capsules, *, with_inside: bool = True) -> Capsules:
    """The capsules with radii such that each small cell of the solid lies within one of them.

    Cells are patches that make up the whole surface, and all voxels inside that are free of
    surface. A capsule is convex: it holds a cell if it holds the corners. Radii first grow and
    shrink to what many points of the surface and the inside need. Cells that no capsule then holds
    are cut, down to edges of 0.2 mm on the surface and 2 mm inside; for what is left radii grow,
    where that takes least. So the surface is held exactly, with `MARGIN` to spare, and so is the
    inside but for what lies in voxels that hold surface too: a cavity left there is thinner than a
    voxel, and the held surface closes it.

    Segments are rounded to `DECIMALS` first; a capsule that no cell needs is left out.

    Args:
        solid: What to hold.
        capsules: Where to begin; segments stay.
        with_inside: Ask it of voxels too; False is faster, for trials.
    """
    a, b = np.round(capsules.a, DECIMALS) + 0.0, np.round(capsules.b, DECIMALS) + 0.0
    radius = capsules.radius.copy()
    coarse = max(_COARSE, float(np.sqrt(5 * areas(solid.triangles).sum() / _MOST_PATCHES)))
    patches = subdivide(solid.triangles, coarse)
    corners = np.unique(patches.reshape(-1, 3), axis=0)
    points = to_segments(np.concatenate([corners, solid.samples.data]), a, b)
    points = np.concatenate([points, _core_needs(solid, a, b)])
    radius = _shrunk(points, _grown(points, radius))  # nearly enough: few cells have to be cut
    needs = [_needs(patches, a, b, radius, bisect, _FINE)]
    if with_inside:
        needs.append(
            _needs(_open_voxels(solid, a, b, radius), a, b, radius, _octants, _FINE_INSIDE)
        )
    need = np.concatenate(needs)
    radius = _grown(need, radius)
    kept = radius > 0
    return Capsules(a[kept], b[kept], np.round(radius[kept] + MARGIN, DECIMALS))


def _needs(
    cells: FloatArray,
    a: FloatArray,
    b: FloatArray,
    radius: FloatArray,
    cut: Callable[[FloatArray], FloatArray],
    fine: float,
) -> FloatArray:
    """Radius with which capsule k would hold cell n, (N', K) [m].

    Cells, given by their corners (N, V, 3), are cut as long as none holds them by its own radius.
    """
    done = [np.empty((0, len(a)))]
    while len(cells):
        need = _corner_needs(cells, a, b)
        size = np.ptp(cells, axis=1).max(axis=1)
        final = (need <= radius).any(axis=1) | (size < fine)
        done.append(need[final])
        cells = cut(cells[~final])
    return np.concatenate(done)


def _corner_needs(cells: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    step = max(_CHUNK // (cells.shape[1] * len(a)), 1)
    parts = [
        to_segments(cells[n : n + step].reshape(-1, 3), a, b)
        .reshape(-1, cells.shape[1], len(a))
        .max(axis=1)
        for n in range(0, len(cells), step)
    ]
    return np.concatenate(parts)


def _octants(cubes: FloatArray) -> FloatArray:
    """Each cube, by its corners (N, 8, 3), in eight."""
    return np.concatenate([(cubes + cubes[:, i : i + 1]) / 2 for i in range(8)])


def _core_needs(solid: Solid, a: FloatArray, b: FloatArray) -> FloatArray:
    """Radius with which capsule k holds a ball around cube n, of two voxels' edge, deep inside."""
    centers, depth = solid.inner_points()
    around = solid.edge * np.sqrt(3)
    even = (np.rint((centers - solid.origin) / solid.edge).astype(int) % 2 == 0).all(axis=1)
    deep = depth > around + solid.edge
    return np.asarray(to_segments(centers[even & deep], a, b) + around)


def _open_voxels(solid: Solid, a: FloatArray, b: FloatArray, radius: FloatArray) -> FloatArray:
    """Voxels inside, corners (N, 8, 3), but for those that a ball around shows to be held."""
    centers, _ = solid.inner_points()
    if not len(centers):
        return np.empty((0, 8, 3))
    around = solid.edge * np.sqrt(3) / 2
    step = max(_CHUNK // len(a), 1)
    loose = np.concatenate(
        [
            (to_segments(centers[n : n + step], a, b) + around > radius).all(axis=1)
            for n in range(0, len(centers), step)
        ]
    )
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(8, 3)
    return centers[loose, None] + solid.edge * corners


def _grown(need: FloatArray, radius: FloatArray) -> FloatArray:
    """Radii with which each cell is held: the worst one grows the capsule it takes least of."""
    radius = radius.copy()
    lack = (need[(need > radius).all(axis=1)] - radius).T.copy()  # (K, N)
    least, of = lack.min(axis=0, initial=np.inf), lack.argmin(axis=0)
    while least.max(initial=0.0) > 0:
        worst = int(least.argmax())
        k, more = int(of[worst]), float(least[worst]) + 1e-12
        radius[k] += more
        lack[k] -= more
        nearer = lack[k] < least
        least[nearer], of[nearer] = lack[k, nearer], k
    return radius


def _shrunk(need: FloatArray, radius: FloatArray) -> FloatArray:
    """Radii each as small as the others allow, 0 where a capsule is not needed.

    In rounds, half of what is possible at a time, so that neighbors share what is to be gained.
    """
    radius = radius.copy()
    holds = np.ascontiguousarray((need <= radius).T)  # (K, N)
    count = holds.sum(axis=0)
    for last in [False] * _SHRINK_ROUNDS + [True]:
        for k in np.argsort(-radius):
            alone = holds[k] & (count == 1)
            least = float(need[alone, k].max(initial=0.0))
            radius[k] = least if last else (least + radius[k]) / 2
            still = (need[:, k] <= radius[k]) & (radius[k] > 0)
            count += still.astype(int) - holds[k]
            holds[k] = still
    return radius
