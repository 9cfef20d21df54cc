"""When to be where on a curve: the fastest way within limits of joints and of the tool."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PPoly

from pdoik import _core
from pdoik.errors import PdoikError
from pdoik.timing.curve import graded
from pdoik.timing.limits import Bounds

FloatArray = npt.NDArray[np.float64]

_CELLS, _MIN_CELLS = 8, 200  # of each of the curve's polynomials, of all of it
_PER_RAMP = 8  # cells until it is at full speed
_LEAST_CELL = 1e-9  # of all of it
_GRADE = 4.0  # the largest ratio of a cell to the next


def fastest(bounds: Bounds) -> PPoly:
    """The place s as a function of time, from rest at the curve's start to rest at its end.

    With x the square of ds/dt and u = x'/2,

        |q'(s) u + q''(s) x| <= acceleration(s),    x <= ceiling(s)

    at both ends of each cell of a grid, on which u is constant (Pham and Pham, A New Approach to
    Time-Optimal Path Parameterization Based on Reachability Analysis, IEEE T-RO 34(3), 2018).

    Args:
        bounds: Of a curve; jerk does not count.

    Raises:
        PdoikError: There is none, to the precision of numbers.
    """
    curve = bounds.curve
    s = _grid(bounds)
    most, acceleration = bounds.ceiling(s), bounds.acceleration(s)
    a, b = curve(s, 1) / acceleration, curve(s, 2) / acceleration
    rate = np.sqrt(_core.fastest_squares(s, a, b, most))
    if not (rate[1:] + rate[:-1] > 0.0).all():
        raise PdoikError("the path cannot be timed: there is no way from rest to rest")
    time = np.concatenate([[0.0], np.cumsum(2 * np.diff(s) / (rate[1:] + rate[:-1]))])
    change = np.diff(rate**2) / np.diff(s) / 2
    return PPoly(np.stack([change / 2, rate[:-1], s[:-1]]), time)


def _grid(bounds: Bounds) -> FloatArray:
    """Several cells in each of the curve's polynomials, and finer ones next to rests."""
    breaks = bounds.curve.breaks
    ends = breaks[[0, -1]]
    change = 1 / np.abs(bounds.curve(ends, 1) / bounds.acceleration(ends)).max(axis=1)
    ramps = bounds.ceiling(ends) / change / 2  # how far it goes until it is at full speed
    first, last = np.clip(ramps / _PER_RAMP, _LEAST_CELL * ends[1], ends[1] / _MIN_CELLS)
    spans = np.diff(breaks)
    parts = np.maximum(_CELLS, np.ceil(spans * _MIN_CELLS / breaks[-1])).astype(int)
    inner = [b + w * np.arange(p) / p for b, w, p in zip(breaks, spans, parts, strict=False)]
    return graded(np.concatenate([*inner, [first, ends[1] - last, ends[1]]]), _GRADE)
