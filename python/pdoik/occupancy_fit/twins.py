"""Surfaces that are another one moved or mirrored, and what was fitted to that one, moved too."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .hulls import DECIMALS, FloatArray, Point, Shape, tidy_point
from .solid import areas
from .surface_fit import Cover, SurfaceFit

_SAME = 1e-6  # by which corners may differ: how much larger moved hulls become at most [m]
_ROUNDING = 2 * 10.0**-DECIMALS  # of ends, of radii, and of the motion itself [m]
_ALIKE = 1e-4  # of sizes, where comparing corners is worth while, as a share


class Motion(NamedTuple):
    """x to R x + t, where R turns, or turns and mirrors; corners come out within `slack`."""

    R: FloatArray  # (3, 3), orthogonal
    t: FloatArray  # (3,) [m]
    slack: float  # [m]

    @property
    def mirrors(self) -> bool:
        return float(np.linalg.det(self.R)) < 0

    def point(self, point: Point | FloatArray) -> Point:
        """Where it comes to, rounded."""
        return tidy_point(self.R @ np.asarray(point) + self.t)


def motion_between(first: FloatArray, second: FloatArray) -> Motion | None:
    """The motion that makes one surface (T, 3, 3) another, triangle by triangle, if one does.

    Triangles may come in any order, and so may their corners. Tried are mirrors at the axes'
    planes, what fits the triangles best in their order (one mesh in two places), and principal
    axes (two files).
    """
    if first.shape != second.shape or not len(first):
        return None
    if np.array_equal(first, second):
        return Motion(np.eye(3), np.zeros(3), 0.0)
    sizes, others = np.sort(areas(first)), np.sort(areas(second))
    if not np.allclose(sizes, others, rtol=_ALIKE, atol=1e-3 * float(sizes.max())):
        return None
    target, faces = _indexed(second)
    tree = cKDTree(target)
    corners, own = _indexed(first)
    if len(corners) != len(target):
        return None
    for R, t in _candidates(first, second):
        distance, nearest = tree.query(corners @ R.T + t)
        slack, index = float(np.max(distance)), np.asarray(nearest)
        if slack <= _SAME and np.array_equal(_listed(index[own]), _listed(faces)):
            return Motion(R, t, slack)
    return None


def moved_fit(fit: SurfaceFit, motion: Motion) -> SurfaceFit:
    """Fit of the surface that the motion gives: it holds that as surely as the fit holds its own.

    What it holds moves by the slack at most, hulls by rounding too: radii grow by both.
    """
    if not motion.slack and np.array_equal(motion.R, np.eye(3)) and not motion.t.any():
        return fit
    more = motion.slack + _ROUNDING
    turn = (0, 2, 1) if motion.mirrors else (0, 1, 2)
    return SurfaceFit(
        covers=tuple(_moved_cover(cover, motion, more) for cover in fit.covers),
        capsules=tuple(
            capsule._replace(
                a=motion.point(capsule.a),
                b=motion.point(capsule.b),
                radius=_rounded_up(capsule.radius + more, DECIMALS),
                overhang=_rounded_up(capsule.overhang + 2 * more, 6),
            )
            for capsule in fit.capsules
        ),
        overhang=fit.overhang,
        pieces=tuple(
            piece._replace(
                vertices=tuple(motion.point(vertex) for vertex in piece.vertices),
                triangles=tuple((t[turn[0]], t[turn[1]], t[turn[2]]) for t in piece.triangles),
                tolerance=_rounded_up(piece.tolerance + more, 6),
            )
            for piece in fit.pieces
        ),
    )


def _moved_cover(cover: Cover, motion: Motion, more: float) -> Cover:
    hulls = [hull._replace(shape=_moved(hull.shape, motion, more)) for hull in cover.hulls]
    return Cover(tuple(hulls), cover.volume)


def _moved(shape: Shape, motion: Motion, more: float) -> Shape:
    a, b = motion.point(shape.focus_a), motion.point(shape.focus_b)
    return Shape(np.array(a), np.array(b), _rounded_up(shape.semi_major + more, DECIMALS))


def _rounded_up(value: float, decimals: int) -> float:
    return round(math.ceil(value * 10.0**decimals) / 10.0**decimals, decimals)


def _indexed(surface: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    """Distinct corners (V, 3), and the triangles by them (T, 3)."""
    corners, index = np.unique(surface.reshape(-1, 3), axis=0, return_inverse=True)
    return corners, index.reshape(-1, 3)


def _listed(faces: NDArray[np.intp]) -> NDArray[np.intp]:
    """The same triangles in one order, whatever theirs and their corners' was."""
    each = np.sort(faces, axis=1)
    return each[np.lexsort(each.T)]


def _candidates(first: FloatArray, second: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    for signs in product((1.0, -1.0), repeat=3):
        yield np.diag(signs), np.zeros(3)
    p, q = first.mean(axis=1), second.mean(axis=1)  # of each triangle, whatever its corners' order
    middle_p, middle_q = p.mean(axis=0), q.mean(axis=0)
    U, _, Vt = np.linalg.svd((p - middle_p).T @ (q - middle_q))
    for sign in (1.0, -1.0):
        R = Vt.T @ np.diag([1.0, 1.0, sign]) @ U.T
        yield R, middle_q - R @ middle_p
    (center_p, axes_p), (center_q, axes_q) = _principal(first), _principal(second)
    for signs in product((1.0, -1.0), repeat=3):
        R = axes_q @ np.diag(signs) @ axes_p.T
        yield R, center_q - R @ center_p


def _principal(surface: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Middle of the surface (3,) and its principal axes as columns (3, 3), by area."""
    weight, middles = areas(surface), surface.mean(axis=1)
    center = weight @ middles / weight.sum()
    return center, np.linalg.eigh((weight[:, None] * (middles - center)).T @ (middles - center))[1]
