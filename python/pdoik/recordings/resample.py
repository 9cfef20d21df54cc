"""Resamples a file's own, possibly uneven times to a uniform grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from .recording import FloatArray

GAP = 5.0
"""Steps of time without a sample beyond which interpolation is no longer data."""

_SAME = 1e-3  # of a step: times so near to a uniform grid are that grid, printed with few digits

HELD = ("q_des", "dq_des", "tau_cmd")
_STEPPED = 0.5  # share of samples equal to the one before from which a command counts as stepped
_RESTING = 0.15  # without a change for so long a command is at rest [s]
"""Channels that keep their value until the next sample: commands."""

SMOOTH = ("q", "tip", "base")
"""Channels interpolated by cubic splines: positions of bodies with inertia."""

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Uniform times for a file's rows."""

    raw: FloatArray  # (R,) the file's times [s], strictly rising from 0
    time: FloatArray  # (T,) [s]
    as_recorded: bool  # the rows lie on the grid already
    period: float
    raw_period: float
    jitter: float


def uniform_grid(raw: FloatArray) -> Grid:
    """The grid for strictly rising times that start at 0: its period is their median step."""
    steps = np.diff(raw)
    raw_period = float(np.median(steps))
    near = steps[steps < GAP * raw_period]
    jitter = float(np.std(near))
    even = float(raw[-1]) / (len(raw) - 1)
    as_recorded = bool(np.abs(raw - even * np.arange(len(raw))).max() < _SAME * even)
    period = even if as_recorded else raw_period
    count = len(raw) if as_recorded else int(np.floor(raw[-1] / period + 1e-6)) + 1
    return Grid(
        raw=raw,
        time=np.arange(count, dtype=np.float64) * period,
        as_recorded=as_recorded,
        period=period,
        raw_period=raw_period,
        jitter=jitter,
    )


def on_grid(grid: Grid, channel: str, values: FloatArray) -> tuple[FloatArray, BoolArray]:
    """A column on the grid, and where it rests on samples.

    Positions go by a cubic spline, commands that keep their value over most samples are held, the
    rest is linear; across gaps all but held commands are linear, beyond the ends all are held.

    Args:
        grid: From `uniform_grid`.
        channel: Decides the interpolation.
        values: (R,), NaN where nothing was logged; at least one is finite.

    Returns:
        (T,) values and (T,) whether a sample is within reach: a gap is longer than `GAP` steps
        of the grid, or of the column's own where it was logged at a lower rate.
    """
    there = np.isfinite(values)
    if grid.as_recorded and there.all():
        return values.astype(np.float64), np.ones(len(values), dtype=np.bool_)
    t, x = grid.raw[there], values[there]
    reach = GAP * max(grid.period, float(np.median(np.diff(t))) if len(t) > 1 else 0.0)
    backed = _within_reach(t, grid.time, reach)
    if channel in HELD and _is_stepped(t, x):
        index = np.searchsorted(t, grid.time + _SAME * grid.period, side="right") - 1
        return x[np.maximum(index, 0)], backed
    out = np.interp(grid.time, t, x)
    if channel in SMOOTH and len(t) >= 4:
        inside = backed & (grid.time >= t[0]) & (grid.time <= t[-1])
        out[inside] = _spline(t, x, grid.time[inside], reach)
    if grid.as_recorded:
        out[there] = x
    return out, backed


def _is_stepped(t: FloatArray, x: FloatArray) -> bool:
    """Whether a command keeps its value over most samples while it moves; rests do not count."""
    changes = np.diff(x) != 0.0
    when = t[1:][changes]
    if not len(when):
        return True
    place = np.searchsorted(when, t[1:])
    since = t[1:] - when[np.maximum(place - 1, 0)]
    until = when[np.minimum(place, len(when) - 1)] - t[1:]
    moving = (np.abs(since) < _RESTING) & (np.abs(until) < _RESTING)
    return float(np.mean(~changes[moving])) > _STEPPED


def _within_reach(t: FloatArray, at: FloatArray, reach: float) -> BoolArray:
    """Whether the samples before and after each time are no farther apart than `reach`."""
    slack = 1e-9 + 1e-6 * reach
    after = np.searchsorted(t, at - slack)
    before = np.searchsorted(t, at + slack, side="right") - 1
    gap = t[np.minimum(after, len(t) - 1)] - t[np.maximum(before, 0)]
    outside = np.maximum(t[0] - at, at - t[-1]) > reach / GAP + slack
    backed: BoolArray = (gap <= reach + slack) & ~outside
    return backed


def _spline(t: FloatArray, x: FloatArray, at: FloatArray, reach: float) -> FloatArray:
    """Cubic spline, begun anew after each gap so that none rings into its neighbours."""
    out = np.interp(at, t, x)
    cuts = np.flatnonzero(np.diff(t) > reach * (1 + 1e-6)) + 1
    for piece in np.split(np.arange(len(t)), cuts):
        if len(piece) >= 4:
            mine = (at >= t[piece[0]]) & (at <= t[piece[-1]])
            out[mine] = CubicSpline(t[piece], x[piece])(at[mine])
    return out
