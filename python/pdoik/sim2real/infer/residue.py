"""Where in a joint's motion that sits which nothing explains: one line each, no finding."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..findings import Residue
from ..motion import Balances, Key

_BINS = 12  # numerics:


def residue_of(b: Balances, key: Key, left: FloatArray) -> Residue:
    """The variable whose value explains most of what is left of a balance.

    Args:
        b: of the recordings that the joint is judged by.
        key: the balance.
        left: (N,) what is left of it at all rows.

    Returns:
        Its share of the variance between the bins of each variable, less what as many bins of a
        variable that means nothing would have (the adjusted R^2 of a piecewise constant).
    """
    j, rows = key[1], b.mask[key]
    variables = {
        "speed": b.sampled([m.dq[:, j] for m in b.motions]),
        "position": b.sampled([m.q[:, j] for m in b.motions]),
        "load": b.sampled([m.borne[:, j] for m in b.motions]),
        "time": b.time,
    }
    shares = {name: _between(x[rows], left[rows]) for name, x in variables.items()}
    best = max(shares, key=lambda name: shares[name])
    least = b.thresholds.diagnosis.shown
    return Residue(of=best, share=shares[best]) if shares[best] > least else Residue()


def _between(x: FloatArray, y: FloatArray) -> float:
    """Share of y's mean square between bins of x, adjusted for their number."""
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, _BINS + 1))) if len(x) else x
    if len(edges) < 3 or len(x) < 4 * _BINS:
        return 0.0
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(place, minlength=len(edges) - 1), 1)
    mean = np.bincount(place, y, minlength=len(edges) - 1) / count
    whole = float(np.sum(y**2))
    inside = float(np.sum((y - mean[place]) ** 2))
    free = len(y) - len(count)
    return float(np.clip(1.0 - inside / max(whole, 1e-300) * len(y) / free, 0.0, 1.0))
