"""Residuals as colours: grey where there is none, through yellow to red."""

from __future__ import annotations

from html import escape

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Rgb = tuple[int, int, int]

NOT_JUDGED: Rgb = (150, 158, 172)
RECORDED: Rgb = (92, 104, 122)
HALF_WINDOW = 0.25  # [s]

_SHARES = np.array([0.0, 0.15, 0.4, 0.7, 1.0])
_STOPS = np.array(
    [[205, 222, 235], [244, 225, 120], [240, 150, 50], [214, 45, 32], [110, 8, 30]], dtype=float
)


def color_of(value: float, most: float) -> Rgb:
    """Colour of a residual, 0 to `most` and beyond; grey where it is not known."""
    if not np.isfinite(value):
        return NOT_JUDGED
    share = min(value / max(most, 1e-12), 1.0)
    red, green, blue = (round(float(np.interp(share, _SHARES, stop))) for stop in _STOPS.T)
    return red, green, blue


def moving_rms(time: FloatArray, residual: FloatArray) -> FloatArray:
    """Root mean square within a quarter of a second to either side, (T, n); NaN without samples."""
    half = max(1, round(HALF_WINDOW / float(time[1] - time[0]))) if len(time) > 1 else 1
    known = np.isfinite(residual)
    total, count = (
        np.cumsum(np.pad(values, ((1, 0), (0, 0))), axis=0)
        for values in (np.where(known, residual, 0.0) ** 2, known.astype(float))
    )
    rows = np.arange(len(time))
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half + 1, len(time))
    n = count[high] - count[low]
    squares = np.maximum(total[high] - total[low], 0.0)
    return np.sqrt(np.where(n > 0, squares / np.maximum(n, 1.0), np.nan))


def legend_html(most: float, unit: str, what: str) -> str:
    """The colours as a bar from 0 to `most`."""
    stops = ", ".join(
        f"rgb{color_of(share, 1.0)} {100 * share:.0f}%" for share in np.linspace(0, 1, 11)
    )
    numbers = "".join(f"<span>{most * share:.3g}</span>" for share in (0.0, 0.25, 0.5, 0.75, 1.0))
    return (
        f'<div style="padding:0 1em 0.3em;font-size:0.85em">{escape(what)} [{escape(unit)}]'
        f'<div style="height:0.9em;border-radius:3px;background:linear-gradient(to right,{stops})">'
        '</div><div style="display:flex;justify-content:space-between;'
        f'font-variant-numeric:tabular-nums">{numbers}</div></div>'
    )
