"""A smooth way along a polyline, within a given distance of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline

FloatArray = npt.NDArray[np.float64]

_DEGREE = 3
_MAX_ROUNDS = 60  # of halving, which brings any span below what numbers resolve
_PROBES = np.array([0.0, 0.25, 0.5, 0.75])  # in each cell that corners and joins leave
_SAME = 1e-11  # of all of it: edges that are no farther apart are one
_KEPT = 0.98  # of the deviation, for what lies between probes


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Joint positions as a function of a place s on it, twice continuously differentiable."""

    breaks: FloatArray  # (M + 1,), where its cubic polynomials join, from 0 to its length
    start: FloatArray  # (n,) [rad] or [m]
    splines: tuple[BSpline, ...]  # what it is beyond that, and its three derivatives
    deviation: float  # largest from the polyline, of a joint [rad] or [m]

    def __call__(self, s: FloatArray, order: int = 0) -> FloatArray:
        """Derivative of an order of the curve at places, shape (k, n)."""
        values: FloatArray = self.splines[order](s)
        return values + self.start if order == 0 else values


def along(rows: FloatArray, s: FloatArray, places: FloatArray) -> FloatArray:
    """The polyline through rows (m, n), each at its s (m,), at other places, shape (k, n)."""
    return np.stack([np.interp(places, s, column) for column in rows.T], axis=-1)


def rounded(rows: FloatArray, s: FloatArray, deviation: float) -> Curve:
    """The polyline f with its corners rounded: its variation diminishing cubic spline.

        C(s) = sum_i f(xi_i) B_i(s),    xi_i = (t_i+1 + t_i+2 + t_i+3) / 3

    This reproduces straight lines and stays in the convex hull of what it takes from f (de Boor, A
    Practical Guide to Splines, ch. XI). Knots t are halved where C is off by more than is allowed,
    so they are close at sharp corners, and as far apart as can be elsewhere. Ends are met exactly.

    Args:
        rows: Corners, shape (m, n) [rad] or [m].
        s: Where they are, rising from 0, shape (m,).
        deviation: Largest |C - f| of a joint, positive [rad] or [m]. A polyline without corners
            is met exactly.
    """
    breaks = s[[0, -1]]
    start, rows = rows[0], rows - rows[0]  # whose derivatives are then exact where it is short
    for _ in range(_MAX_ROUNDS):
        spline = _variation_diminishing(rows, s, breaks)
        cells = np.union1d(s, breaks)
        places = np.append((cells[:-1, None] + np.diff(cells)[:, None] * _PROBES).ravel(), s[-1])
        off = np.abs(spline(places) - along(rows, s, places)).max(axis=1)
        spans = np.searchsorted(breaks, places[off > _KEPT * deviation], side="right") - 1
        if not len(spans):
            break
        spans = np.unique(np.minimum(spans, len(breaks) - 2))
        breaks = np.sort(np.append(breaks, (breaks[spans] + breaks[spans + 1]) / 2))
    splines = (spline, *(spline.derivative(order) for order in (1, 2, 3)))
    return Curve(breaks, start, splines, float(off.max()))


def _variation_diminishing(rows: FloatArray, s: FloatArray, breaks: FloatArray) -> BSpline:
    knots = np.concatenate([[breaks[0]] * _DEGREE, breaks, [breaks[-1]] * _DEGREE])
    greville = np.lib.stride_tricks.sliding_window_view(knots[1:-1], _DEGREE).mean(axis=1)
    return BSpline(knots, along(rows, s, greville), _DEGREE)


def graded(edges: FloatArray, ratio: float) -> FloatArray:
    """Edges of cells in order, with more between them so that no cell is so many times the next.

    Args:
        edges: From 0 on in any order, shape (m,). Two that are one but for rounding are one.
        ratio: More than 3.
    """
    edges = np.unique(edges)
    apart = np.diff(edges) > _SAME * edges[-1]
    edges = np.append(edges[:-1][apart], edges[-1])  # the first of two that are one is left out
    edges[0] = 0.0
    while True:
        cells = np.diff(edges)
        left = np.flatnonzero(cells[1:] > ratio * cells[:-1])  # of which the next is too wide
        right = np.flatnonzero(cells[:-1] > ratio * cells[1:])
        if not len(left) + len(right):
            return edges
        more = [edges[left + 1] + 2 * cells[left], edges[right + 1] - 2 * cells[right + 1]]
        edges = np.unique(np.concatenate([edges, *more]))
