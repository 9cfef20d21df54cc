"""The fastest way on a curve within limits of jerk too."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import ndimage, sparse
from scipy.interpolate import BSpline, PPoly
from scipy.optimize import linprog

from pdoik.timing.curve import graded
from pdoik.timing.limits import Bounds

FloatArray = npt.NDArray[np.float64]
Sparse = Any  # scipy.sparse.csr_array, of whose products its stubs say too little

_PER_RAMP = 6  # cells in the time that acceleration takes to be ramped up
_MIN_CELLS, _MAX_CELLS = 150, 800  # besides those that the curve's polynomials ask for
_QUIET = 0.05  # of the greatest use of acceleration, up to which joints go evenly
_SHARES = 10  # of a ramp, in which it is looked at
_APART = 0.3  # of a cell: what even edges are kept off those that the curve asks for
_SAME = 1e-4  # of a cell: edges that are no farther apart are one
_GRADE = 4.0  # the largest ratio of a cell to the next
_COLLOCATION = np.array([0.01, 0.2, 0.4, 0.6, 0.8, 0.99])  # of each cell
_PIECES = 4  # of each cell, in the answer

_TIGHT = 0.3  # a limit that is used but for this share is in the linear program
_LOOSE = 1e-6  # what it leaves of a limit is this or less
_LEAST, _MOST = 0.1, 4.0  # of x, from one linear program to the next
_ENOUGH = 1e-3  # the gain of time with which they end
_MAX_ROUNDS = 30
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(4)


def within_jerk(bounds: Bounds, motion: PPoly, ramp: float) -> PPoly:
    """A motion, slowed so that jerk is within limits too, and as fast as a descent makes it.

    The motion is smoothed in time first, s = g(sigma), so that it begins and ends as the cube of
    time. Then x, the square of dsigma/dt, is sought as a quadratic spline. With Q = q(g(sigma)),
    speed, acceleration and jerk of joints are

        Q' sqrt(x),    Q'' x + Q' x'/2,    sqrt(x) (Q''' x + 3/2 Q'' x' + Q' x''/2)

    The last is divided by sqrt(x), and 1 / sqrt(x), which is convex, is replaced by its tangent,
    which is below it: each answer of the linear program is within limits and where the next one
    starts (Debrouwere et al., Time-Optimal Path Following for Robots With Convex-Concave
    Constraints Using Sequential Convex Programming, IEEE T-RO 29(6), 2013).

    Args:
        bounds: Of a curve; one of jerk at least is finite.
        motion: The place s by time, from rest to rest, within the other limits.
        ramp: In which acceleration comes to what the motion has, at the largest jerk [s].

    Returns:
        s by time. Limits hold at several points of each cell, and nearly so between them.
    """
    even = _even(bounds, motion, ramp)
    warp = _smoothed(motion, ramp, even)
    edges = _edges(bounds.curve.breaks, warp, even)
    x = _Program(bounds, warp, edges).solve()
    pieces = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(_PIECES) / _PIECES
    return _by_time(warp, x, np.append(pieces.ravel(), edges[-1]))


def _even(bounds: Bounds, motion: PPoly, ramp: float) -> FloatArray:
    """Edges of cells: several in the time of a ramp, but few where joints go evenly for long."""
    end = motion.x[-1]
    wide = end + ramp
    t = np.linspace(-ramp, wide, int(np.clip(_SHARES * wide / ramp, 1000, 100_000)))
    moving = np.clip(t, 0.0, end)
    s, rate, change = (motion(moving, order) for order in range(3))
    ddq = bounds.curve(s, 2) * rate[:, None] ** 2 + bounds.curve(s, 1) * change[:, None]
    used = np.abs(ddq / bounds.acceleration(s)).max(axis=1)
    reach = int(np.ceil(2 * ramp / (t[1] - t[0])))
    busy = ndimage.maximum_filter1d(used, 2 * reach + 1) > _QUIET * used.max()
    density = np.where(busy, _PER_RAMP / ramp, _MIN_CELLS / wide)[t >= 0.0]
    count = np.append(0.0, np.cumsum(density[1:])) * (t[1] - t[0])
    cells = int(np.clip(count[-1], _MIN_CELLS, _MAX_CELLS))
    edges = np.interp(np.linspace(0.0, count[-1], cells + 1), count, t[t >= 0.0])
    edges[0], edges[-1] = 0.0, wide
    return edges


def _smoothed(motion: PPoly, width: float, edges: FloatArray) -> BSpline:
    """The mean of a motion over the last `width` of time: s by sigma, C3, a cube at both ends.

    It is a variation diminishing spline, so it rises as the motion does.
    """
    end, length = motion.x[-1], motion(motion.x[-1])
    knots = np.concatenate([edges[:1]] * 4 + [edges] + [edges[-1:]] * 4)
    sigma = np.lib.stride_tricks.sliding_window_view(knots[1:-1], 4).mean(axis=1)
    integral = motion.antiderivative()

    def summed(t: FloatArray) -> FloatArray:
        values: FloatArray = integral(np.clip(t, 0.0, end)) + length * np.maximum(t - end, 0.0)
        return values

    c = (summed(sigma) - summed(sigma - width)) / width
    c[:3], c[-3:] = 0.0, length
    return BSpline(knots, c, 4)


def _edges(joins: FloatArray, warp: BSpline, even: FloatArray) -> FloatArray:
    """The even ones, and where the curve's third derivative jumps; graded, one to the next."""
    jumps = joins[1:-1]
    low, high = np.zeros(len(jumps)), np.full(len(jumps), even[-1])
    for _ in range(60):
        middle = (low + high) / 2
        before = warp(middle) < jumps
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    width = np.interp(high, even[1:], np.diff(even))
    apart = np.minimum(high, even[-1] - high) > _SAME * width
    jumps = high[apart & (np.diff(high, prepend=-1.0) > _SAME * width)]
    gaps = np.minimum(np.diff(even, prepend=-np.inf), np.diff(even, append=np.inf))
    away = np.abs(even[:, None] - jumps).min(axis=1, initial=np.inf) > _APART * gaps
    away[[0, -1]] = True
    return graded(np.concatenate([even[away], jumps]), _GRADE)


class _Program:
    """Least time over quadratic splines x within |A x| <= 1, C x <= 1, |J x| <= 1 / sqrt(x)."""

    def __init__(self, bounds: Bounds, warp: BSpline, edges: FloatArray) -> None:
        curve = bounds.curve
        sigma = (edges[:-1, None] + np.diff(edges)[:, None] * _COLLOCATION).ravel()  # (P,)
        g, g1, g2, g3 = (warp(sigma, order)[:, None] for order in range(4))
        s = np.clip(g[:, 0], 0.0, curve.breaks[-1])
        q1, q2, q3 = (curve(s, order) for order in (1, 2, 3))  # (P, n)
        Q1 = q1 * g1
        Q2 = q2 * g1**2 + q1 * g2
        Q3 = q3 * g1**3 + 3 * q2 * g1 * g2 + q1 * g3
        self.knots = np.concatenate([edges[:1]] * 2 + [edges] + [edges[-1:]] * 2)
        B = _bases(self.knots, sigma)

        def rows(*parts: FloatArray) -> Sparse:
            """Rows of each joint: the sum of its column in each part times a derivative of x."""
            return _stacked(
                sum(sparse.diags_array(part[:, joint]) @ B[k] for k, part in enumerate(parts))
                for joint in range(parts[0].shape[1])
            )

        a, j = bounds.acceleration(s), bounds.jerk(s)
        A = rows(Q2 / a, Q1 / a / 2)
        J = rows(Q3 / j, 1.5 * Q2 / j, Q1 / j / 2)
        C = rows(g1**2 / bounds.ceiling(s)[:, None])
        self.x = B[0]  # values at the P points, of its coefficients
        self.x_of_jerk = _stacked([B[0]] * (2 * j.shape[1]))
        self.other = _stacked([A, -A, C])
        self.jerk = _stacked([J, -J])

    def solve(self) -> BSpline:
        """The best that descent finds from a motion evenly slowed."""
        c = np.ones(self.x.shape[1])
        c /= max((self.other @ c).max(), (self.jerk @ c).max() ** (2 / 3))
        kept = np.zeros(self.other.shape[0] + self.jerk.shape[0], dtype=bool)
        time = np.inf
        for _ in range(_MAX_ROUNDS):
            x = self.x_of_jerk @ c
            tangent = sparse.diags_array(x**-1.5 / 2) @ self.x_of_jerk
            rows = _stacked([self.other, self.jerk + tangent])
            level = np.append(np.ones(self.other.shape[0]), 1.5 * x**-0.5)
            room = level - rows @ c
            kept |= room < _TIGHT * level
            found = linprog(
                -(self.x.T @ (self.x @ c) ** -1.5),  # downhill of the time, 2 sum of x^-1/2
                A_ub=rows[kept],
                b_ub=level[kept],
                bounds=list(zip(_LEAST * c, _MOST * c, strict=True)),
                method="highs-ds",
            )
            if found.status != 0:
                break
            step = found.x - c
            used = (rows @ step) / (np.maximum(room, 0.0) + _LOOSE * level)
            missing = _worst_of_each(used, self.x.shape[0]) & ~kept
            c = c + step / max(used.max(), 1.0)  # what was left out holds as well
            kept |= missing
            before, time = time, float(np.sum((self.x @ c) ** -0.5))
            if time > (1 - _ENOUGH) * before and not missing.any():
                break
        return BSpline(self.knots, c, 2)


def _bases(knots: FloatArray, sigma: FloatArray) -> list[Sparse]:
    """A quadratic spline and its two derivatives at places, of its coefficients."""
    result: list[Sparse] = []
    derive: Sparse = sparse.eye_array(len(knots) - 3, format="csr")
    for order, degree in enumerate((2, 1, 0)):
        t = knots[order : len(knots) - order]
        result.append(sparse.csr_array(BSpline.design_matrix(sigma, t, degree)) @ derive)
        if degree:
            widths = (t[degree + 1 : -1] - t[1 : -degree - 1]) / degree
            derive = sparse.diags_array(1 / widths) @ (derive[1:] - derive[:-1])
    return result


def _stacked(parts: Iterable[Sparse]) -> Sparse:
    return sparse.csr_array(sparse.vstack(list(parts)))


def _worst_of_each(used: FloatArray, points: int) -> npt.NDArray[np.bool_]:
    """Mask of the rows: the one of each point that is used most, where that is too much."""
    by_point = used.reshape(-1, points)
    worst = np.zeros_like(by_point, dtype=bool)
    worst[by_point.argmax(axis=0), np.arange(points)] = by_point.max(axis=0) > 1.0
    return worst.ravel()


def _by_time(warp: BSpline, x: BSpline, sigma: FloatArray) -> PPoly:
    """The place by time: its rate is Hermite's cubic, and a bubble for what that misses of s."""
    half = np.diff(sigma)[:, None] / 2
    inner = sigma[:-1, None] + half * (1 + _GAUSS)
    step = (half * _WEIGHTS * x(inner) ** -0.5).sum(axis=1)
    gone = (half * _WEIGHTS * warp(inner, 1)).sum(axis=1)
    g1, g2 = warp(sigma, 1), warp(sigma, 2)
    rate, change = g1 * np.sqrt(x(sigma)), g2 * x(sigma) + g1 * x(sigma, 1) / 2
    rate[[0, -1]], change[[0, -1]] = 0.0, 0.0
    mean = np.diff(rate) / step
    first, last = change[:-1] - mean, change[1:] - mean
    hermite = step * (rate[:-1] + rate[1:]) / 2 - step**2 * np.diff(change) / 12
    bubble = 30 * (gone - hermite) / step  # times w^2 (1 - w)^2, with w from 0 to 1 in a step
    s = np.append(0.0, np.cumsum(gone))
    c = [
        bubble / step**4 / 5,
        (first + last) / step**2 / 4 - bubble / step**3 / 2,
        bubble / step**2 / 3 - (2 * first + last) / step / 3,
        change[:-1] / 2,
        rate[:-1],
        s[:-1],
    ]
    return PPoly(np.stack(c), np.append(0.0, np.cumsum(step)))
