"""Radii with which capsules hold a solid, proven cell by cell, and no larger than that takes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .hulls import DECIMALS, MARGIN, FloatArray
from .segments import AnyFloats, Capsules, to_segments
from .solid import Solid, areas, bisect, subdivide

_COARSE = 6e-3  # edges of patches at first [m]
_FINE, _FINE_INSIDE = 0.2e-3, 2e-3  # edges of patches and cubes where cutting ends [m]
_MOST_PATCHES = 30_000  # at first
_CHUNK = 400_000  # entries of a matrix of corners by capsules
_SHRINK_ROUNDS = 4


class Proof:
    """Radii such that each small cell of a solid lies within one of the capsules.

    Cells are patches that make up the whole surface, and all voxels inside that are free of
    surface. A capsule is convex: it holds a cell if it holds the corners. Radii first grow and
    shrink to what many points of the surface and the inside need. Cells that no capsule then holds
    are cut, down to edges of 0.2 mm on the surface and 2 mm inside; for what is left radii grow,
    where that takes least. So the surface is held exactly, with `MARGIN` to spare, and so is the
    inside but for what lies in voxels that hold surface too: a cavity left there is thinner than a
    voxel, and the held surface closes it.
    """

    def __init__(self, solid: Solid) -> None:
        coarse = max(_COARSE, float(np.sqrt(5 * areas(solid.triangles).sum() / _MOST_PATCHES)))
        self._solid = solid
        self._patches = subdivide(solid.triangles, coarse)
        corners = np.unique(self._patches.reshape(-1, 3), axis=0)
        self._points = np.concatenate([corners, solid.samples.data])

    def approximate(self, capsules: Capsules) -> Capsules:
        """The capsules with about the radii that `settle` gives, in a fraction of the time.

        Only many points of the surface are held, so radii come out some tenths of a millimetre
        too small.
        """
        need = to_segments(self._points.astype(np.float32), capsules.a, capsules.b)
        radius = _shrunk(need, _grown(need, capsules.radius))
        kept = radius > 0
        return Capsules(capsules.a[kept], capsules.b[kept], radius[kept] + MARGIN)

    def settle(self, capsules: Capsules) -> Capsules:
        """The capsules with proven radii, no larger than that takes.

        Segments are rounded to `DECIMALS` first; a capsule that no cell needs is left out.
        """
        a, b = np.round(capsules.a, DECIMALS) + 0.0, np.round(capsules.b, DECIMALS) + 0.0
        points = np.concatenate([to_segments(self._points, a, b), _core_needs(self._solid, a, b)])
        radius = _shrunk(points, _grown(points, capsules.radius))  # few cells have to be cut then
        voxels = _open_voxels(self._solid, a, b, radius)
        need = np.concatenate(
            [
                _needs(self._patches, a, b, radius, bisect, _FINE),
                _needs(voxels, a, b, radius, _octants, _FINE_INSIDE),
            ]
        )
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


def _grown(need: AnyFloats, radius: FloatArray) -> FloatArray:
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


def _shrunk(need: AnyFloats, radius: FloatArray) -> FloatArray:
    """Radii each as small as the others allow, 0 where a capsule is not needed.

    In rounds, half of what is possible at a time, so that neighbors share what is to be gained.
    """
    radius = radius.copy()
    held = [np.flatnonzero(need[:, k] <= radius[k]) for k in range(len(radius))]
    needs = [need[at, k] for k, at in enumerate(held)]
    count = np.bincount(np.concatenate(held), minlength=len(need))
    for last in [False] * _SHRINK_ROUNDS + [True]:
        for k in np.argsort(-radius):
            alone = needs[k][count[held[k]] == 1]
            least = float(alone.max(initial=0.0))
            radius[k] = least if last else (least + radius[k]) / 2
            still = (needs[k] <= radius[k]) & (radius[k] > 0)
            count[held[k][~still]] -= 1
            held[k], needs[k] = held[k][still], needs[k][still]
    return radius
