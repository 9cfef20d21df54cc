"""The probability that a finding is there: what speaks for it, calibrated once on worlds.

Posterior log odds suppose that all laws are right. They are not, and a wrong law's misfit is as
certain as a cause's part. How much the odds, the gain and the number of machines with the
effect count is given by a logistic regression on worlds whose truth is known.
"""

from __future__ import annotations

import numpy as np

from ..findings import Support
from ..thresholds import Thresholds

_LEAST_SHARE = 1e-3
_LEAST_SIZE = 0.05


def features(support: Support) -> dict[str, float]:
    """What the log odds are linear in, by the names of their weights."""
    if support.log_odds is None or support.event:
        return _by_gain(support)
    return {
        "there": 1.0,
        "odds": float(np.log1p(max(support.log_odds, 0.0))),
        "explains": _log_odds(support.gain),
        "many": float(support.had_by == "many"),
        "all": float(support.had_by == "all"),
    }


def confidence_of(thresholds: Thresholds, support: Support | None) -> float:
    """Probability by a logistic model of the support; one figure for channels, which have none."""
    weights = thresholds.confidence
    if support is None:
        return weights.unsupported
    odds = sum(getattr(weights, name) * value for name, value in features(support).items())
    return float(1.0 / (1.0 + np.exp(-odds)))


def _by_gain(support: Support) -> dict[str, float]:
    """Features of laws and events, which were never compared with all else in the model."""
    return {
        "base": 1.0,
        "size": float(np.log(max(support.size, _LEAST_SIZE))),
        "gain": _log_odds(support.gain),
        "event": float(support.event),
    }


def _log_odds(share: float) -> float:
    """Log odds of a share, kept within what can be distinguished from none and all."""
    kept = float(np.clip(share, _LEAST_SHARE, 1.0 - _LEAST_SHARE))
    return float(np.log(kept / (1.0 - kept)))
