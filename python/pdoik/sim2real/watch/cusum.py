"""Cumulative sums of log likelihood ratios, and how seldom they alarm by chance.

A chart adds up the log likelihood ratio of "the coefficient of a column has changed by delta"
against "it has not", never below zero (Page, Biometrika 41, 1954; Basseville and Nikiforov,
Detection of Abrupt Changes, 1993, Sec. 2.2 and 7.2). Where the residual remembers, its noise
counts by the spectral density at frequency zero instead of the variance (Johnson and Bagshaw,
Technometrics 16, 1974): over times longer than that memory the sum is then a Brownian motion whose
drift is minus half its variance, whatever the correlation.
"""

from __future__ import annotations

import numpy as np
from scipy import optimize

from pdoik.recordings import FloatArray


def average_run_length(
    threshold: FloatArray | float, information: FloatArray | float
) -> FloatArray:
    """Mean time to a false alarm of a one-sided chart that starts at zero [s].

    E[T] = (exp(h) - h - 1) / mu, of a Brownian motion with drift -mu and variance 2 mu per second
    (Siegmund, Sequential Analysis, 1985, Eq. 2.52 in the limit of small steps).

    Args:
        threshold: h.
        information: mu, the rate at which a change of exactly delta adds to the chart [1/s].
    """
    h = np.asarray(threshold, dtype=np.float64)
    return np.asarray((np.expm1(h) - h) / np.asarray(information), dtype=np.float64)


def threshold_for(information: FloatArray, rate: float) -> float:
    """The one h with which charts together give this many false alarms a second.

    Args:
        information: of each one-sided chart [1/s].
        rate: of all together [1/s].
    """
    total = float(np.sum(information))
    if not total > 0.0:
        return np.inf
    return float(
        optimize.brentq(lambda h: np.log(np.expm1(h) - h) - np.log(total / rate), 1e-3, 300.0)
    )


class Cusum:
    """Charts side by side; arrays have the shape of `charts`."""

    def __init__(self, charts: tuple[int, ...]) -> None:
        """All begin at zero."""
        self.value: FloatArray = np.zeros(charts)
        self.since: FloatArray = np.full(charts, -np.inf)  # time of the last zero

    def reset(self) -> None:
        """Begin at zero again, the time of the last zero not known."""
        self.value[:] = 0.0
        self.since[:] = -np.inf

    def update(
        self, time: FloatArray, increments: FloatArray, threshold: float
    ) -> tuple[int, FloatArray]:
        """Add rows until one of the charts crosses the threshold.

        Args:
            time: (N,) of the rows.
            increments: (N, *charts).
            threshold: h.

        Returns:
            Rows that were added, the crossing one last, and the charts after each (N', *charts).
        """
        total = np.cumsum(increments, axis=0)
        lowest = np.minimum.accumulate(total, axis=0)
        path = np.maximum(total - lowest, total + self.value)
        over = np.flatnonzero((path >= threshold).reshape(len(path), -1).any(axis=1))
        used = int(over[0]) + 1 if len(over) else len(path)
        path = path[:used]
        if not used:
            return 0, path
        self.value = path[-1].copy()
        zero = path <= 0.0
        last = np.where(zero, time[:used].reshape(-1, *[1] * (path.ndim - 1)), -np.inf)
        self.since = np.maximum(self.since, last.max(axis=0))
        return used, path
