"""Long series made small enough to draw: envelopes, medians by bins, samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray

BINS = 18
LEAST = 12  # samples that make a bin's median worth drawing


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Binned:
    """Median and quartiles of y by bins of x, each (k,)."""

    x: FloatArray
    median: FloatArray
    low: FloatArray
    high: FloatArray
    rms: FloatArray


def rms(values: FloatArray) -> float:
    """Root mean square of what is known; NaN if nothing is."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def binned(x: FloatArray, y: FloatArray, bins: int = BINS) -> Binned:
    """Bins of equal width over the bulk of x, without those that hold too few samples."""
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    empty = np.empty(0)
    if len(x) < LEAST or np.ptp(x) <= 0:
        return Binned(x=empty, median=empty, low=empty, high=empty, rms=empty)
    edges = np.linspace(np.quantile(x, 0.003), np.quantile(x, 0.997), bins + 1)
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, bins - 1)
    rows = []
    for k in range(bins):
        inside = place == k
        if np.count_nonzero(inside) >= LEAST:
            low, median, high = np.quantile(y[inside], [0.25, 0.5, 0.75])
            rows.append((float(np.mean(x[inside])), median, low, high, rms(y[inside])))
    middle, median, low, high, root = np.array(rows).reshape(-1, 5).T
    return Binned(x=middle, median=median, low=low, high=high, rms=root)


def envelope(x: FloatArray, y: FloatArray, columns: int = 700) -> tuple[FloatArray, FloatArray]:
    """A line that looks like y over x: of each column of the picture, the lowest and highest."""
    if len(x) <= 2 * columns:
        return x, y
    edges = np.linspace(0, len(x), columns + 1).astype(int)
    filled_low, filled_high = (
        np.where(np.isfinite(y), y, np.inf),
        np.where(np.isfinite(y), y, -np.inf),
    )
    low = np.minimum.reduceat(filled_low, edges[:-1])
    high = np.maximum.reduceat(filled_high, edges[:-1])
    low[~np.isfinite(low)], high[~np.isfinite(high)] = np.nan, np.nan
    return np.repeat(x[edges[:-1]], 2), np.column_stack([low, high]).ravel()


def sample(count: int, most: int, seed: int = 0) -> np.typing.NDArray[np.intp]:
    """Rising indices of at most `most` of `count`, without a rhythm."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(seed).choice(count, most, replace=False))


def reach(*series: FloatArray, share: float = 0.998) -> tuple[float, float]:
    """Ends of an axis that holds zero and all but the last outliers."""
    known = [each[np.isfinite(each)] for each in series]
    ends = [np.quantile(each, [1 - share, share]) for each in known if each.size]
    low = min([0.0, *(float(end[0]) for end in ends)])
    high = max([0.0, *(float(end[1]) for end in ends)])
    pad = 0.12 * (high - low) or 1.0
    return low - pad, high + pad


def busiest(time: FloatArray, values: FloatArray, seconds: float) -> slice:
    """The stretch of `seconds` with the largest squared values."""
    period = float(np.median(np.diff(time))) if len(time) > 1 else 1.0
    width = max(2, min(len(time), round(seconds / period)))
    total = np.concatenate([[0.0], np.cumsum(np.nan_to_num(values) ** 2)])
    start = int(np.argmax(total[width:] - total[:-width]))
    return slice(start, start + width)
