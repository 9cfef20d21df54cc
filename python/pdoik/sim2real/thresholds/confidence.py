"""How sure a finding is, by what speaks for it."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold

_FITTED = "bench/confidence: logistic regression on concealed worlds of development"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfidenceThresholds(Group):
    """Weights of the log odds that a finding is there."""

    base: float = threshold(0.0, "log odds where all else is zero", "", _FITTED)
    clear: float = threshold(1.0, "per natural logarithm of t, over 3.5", "", _FITTED)
    gain: float = threshold(0.5, "per log odds of the gain", "", _FITTED)
    agree: float = threshold(2.0, "per share of folds that agree, over one half", "", _FITTED)
    left: float = threshold(-0.5, "per natural logarithm of what is left", "", _FITTED)
    rivals: float = threshold(-0.5, "where another name does as well", "", _FITTED)
    unsupported: float = threshold(
        0.9, "of what no fold can be left out for: events and channels", "", _FITTED
    )
    suspected: float = threshold(0.5, "below which a finding is suspected, not claimed")
