"""Zero-phase filtering and differentiation, the same for both sides of every balance."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.ndimage import maximum_filter1d

from pdoik.recordings import FloatArray

_HIGHEST = 0.9  # numerics: share of Nyquist's frequency, from which nothing is filtered
_BAND = 0.95  # numerics: share of it up to which a spectrum is looked at
_ORDER = 4  # of the Butterworth filter, run forwards and backwards


def zero_phase(
    values: FloatArray, cutoff: float, period: float, *, noisy: bool = False
) -> FloatArray:
    """Low-pass along axis 0 without delay (Butterworth, forwards and backwards).

    Args:
        values: (T, ...), NaN columns stay NaN.
        cutoff: [Hz]; at or above 0.9 of Nyquist nothing is filtered.
        period: [s].
        noisy: beyond its ends it goes on as in a mirror. Without, it turns about its first and last
            value, as what is smooth does; where these are mostly noise they are not to be followed.
    """
    nyquist = 0.5 / period
    if cutoff >= _HIGHEST * nyquist or len(values) < 3:
        return np.asarray(values, dtype=np.float64)
    sections, rest = _sections(cutoff / nyquist)
    pad = min(len(values) - 1, int(3 / (cutoff * period)))
    before, after = values[pad:0:-1], values[-2 : -pad - 2 : -1]
    if not noisy:
        before, after = 2.0 * values[:1] - before, 2.0 * values[-1:] - after
    there = np.concatenate([before, values, after])
    rest = rest.reshape(rest.shape + (1,) * (values.ndim - 1))
    for _ in range(2):  # forwards, and backwards; each begins at rest at the first value
        there, _state = signal.sosfilt(sections, there, axis=0, zi=rest * there[:1])
        there = there[::-1]
    return np.ascontiguousarray(there[pad : len(there) - pad], dtype=np.float64)


@lru_cache(maxsize=64)
def _sections(ratio: float) -> tuple[FloatArray, FloatArray]:
    """The filter with this cut-off over Nyquist's frequency, and its state at rest at one."""
    sections = np.asarray(signal.butter(_ORDER, ratio, output="sos"), dtype=np.float64)
    return sections, np.asarray(signal.sosfilt_zi(sections), dtype=np.float64)


def derivative(values: FloatArray, period: float) -> FloatArray:
    """Derivative along axis 0 by five-point central differences; one-sided at the ends."""
    result = np.gradient(values, period, axis=0)
    if len(values) >= 5:
        inner = 8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])
        result[2:-2] = inner / (12.0 * period)
    return np.asarray(result, dtype=np.float64)


def shifted(values: FloatArray, delay: float, period: float) -> FloatArray:
    """values(t - delay) by linear interpolation, the first value held before the start."""
    time = np.arange(len(values)) * period
    flat = values.reshape(len(values), -1)
    columns = [np.interp(time - delay, time, column) for column in flat.T]
    return np.stack(columns, axis=1).reshape(values.shape)


def lagged(values: FloatArray, time_constant: float, period: float) -> FloatArray:
    """First-order lag along axis 0, at rest at the first value; exact for straight lines between.

    A filter that holds its input over a sample would itself be half a sample early.
    """
    ratio = period / time_constant
    a = float(np.exp(-ratio))
    now, before = 1.0 - (1.0 - a) / ratio, (1.0 - a) / ratio - a
    state = ((before + a) * values[:1]).astype(np.float64)
    filtered, _ = signal.lfilter([now, before], [1.0, -a], values, axis=0, zi=state)
    return np.asarray(filtered, dtype=np.float64)


def noise_density(values: FloatArray, period: float, above: float = 0.0) -> FloatArray:
    """One-sided power density of white noise, from the spectrum above a frequency.

    The median over the frequencies from `above` (or half of Nyquist where that is higher) up to
    0.95 of Nyquist, so that lines in the spectrum do not count. Per column, [unit^2/Hz].
    """
    nyquist = 0.5 / period
    length = min(256, len(values))
    known = np.isfinite(values).all(axis=0)  # SciPy refuses the NaN columns of absent channels
    frequency, density = signal.welch(
        np.where(known, values, 0.0), fs=1.0 / period, nperseg=length, axis=0, detrend=_detrended
    )
    density = np.where(known, density, np.nan)
    low = min(max(above, 0.5 * nyquist), 0.8 * nyquist)
    band = (frequency >= low) & (frequency <= _BAND * nyquist)
    # The median of a chi-squared with 2 degrees of freedom per average is ln 2 of its mean; with
    # Welch's averaging it is close to the mean: the bias is below 10 % from three segments on.
    return np.asarray(np.median(density[band], axis=0), dtype=np.float64)


def _detrended(segment: FloatArray) -> FloatArray:
    """A segment (..., T) without its straight line, as SciPy's own, which is slow."""
    line = _line(segment.shape[-1])
    return np.asarray(segment - (segment @ line) @ line.T)


@lru_cache(maxsize=16)
def _line(count: int) -> FloatArray:
    """Orthonormal columns that span straight lines, (count, 2)."""
    return np.linalg.qr(np.column_stack([np.ones(count), np.arange(count)]))[0]


def dilated(mask: NDArray[np.bool_], by: int) -> NDArray[np.bool_]:
    """True wherever the mask is True within `by` samples along axis 0."""
    if by <= 0 or not mask.any():
        return mask
    wide = maximum_filter1d(mask.view(np.uint8), 2 * by + 1, axis=0, mode="constant")
    return np.asarray(wide, dtype=np.bool_)
