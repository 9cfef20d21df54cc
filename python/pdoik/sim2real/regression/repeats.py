"""Rows that say the same: errors of neighbouring rows are alike, and count as fewer."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray

from ..motion import Balances


def repeats(parts: Iterable[FloatArray]) -> float:
    """One and twice the sum of the autocorrelation of stretches of a residual.

    Sums end where the correlation first is no longer positive (Geyer, Statistical Science 7(4),
    1992).
    """
    total = np.zeros(0)
    for each in parts:
        if not len(each):
            continue
        spectrum = np.abs(np.fft.rfft(each, 2 * len(each))) ** 2
        own = np.fft.irfft(spectrum)[: len(each)]
        size = max(len(total), len(own))
        total = np.pad(total, (0, size - len(total))) + np.pad(own, (0, size - len(own)))
    if not len(total) or total[0] <= 0.0:
        return 1.0
    correlation = total / total[0]
    below = np.flatnonzero(correlation <= 0.0)
    last = int(below[0]) if len(below) else len(correlation)
    return float(1.0 + 2.0 * np.sum(correlation[1:last]))


def repeats_of(balances: Balances, rows: NDArray[np.intp], left: FloatArray) -> float:
    """The same of what is left on some rows, nothing on the others."""
    series = np.zeros(balances.count)
    series[rows] = left
    return repeats(np.split(series, balances.starts[1:-1]))
