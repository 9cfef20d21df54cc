"""The probability that a finding is there, from what speaks for it."""

from __future__ import annotations

import numpy as np

from ..findings import Support
from ..thresholds import Thresholds

_LEAST_T, _LEAST_GAIN = 0.1, 1e-3


def confidence_of(thresholds: Thresholds, support: Support | None) -> float:
    """By a logistic model of its support; one figure for what has none."""
    weights = thresholds.confidence
    if support is None or not support.folds:
        return weights.unsupported
    odds = (
        weights.base
        + weights.clear * np.log(max(support.t, _LEAST_T) / 3.5)
        + weights.gain * log_odds(support.gain)
        + weights.agree * (support.agree / support.folds - 0.5)
        + weights.left * np.log(max(support.left, 1.0))
        + weights.rivals * bool(support.rivals)
    )
    return float(1.0 / (1.0 + np.exp(-odds)))


def log_odds(share: float) -> float:
    """Of a share, kept within what can be told from none and all."""
    kept = float(np.clip(share, _LEAST_GAIN, 1.0 - _LEAST_GAIN))
    return float(np.log(kept / (1.0 - kept)))
