"""How sure a finding is, by what speaks for it."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold

_FITTED = "bench/confidence.py: logistic regression on concealed worlds of development"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfidenceThresholds(Group):
    """Weights of the log odds that a finding is there, and what is made of them."""

    base: float = threshold(2.08, "log odds where half of what is left is gained", "", _FITTED)
    gain: float = threshold(
        0.45,
        "per log odds of the gain: its share of what is left on left-out sessions",
        "",
        _FITTED,
    )
    rivals: float = threshold(-0.77, "where another name does as well", "", _FITTED)
    unsupported: float = threshold(
        0.9, "confidence of what no session can be left out for: events and channels", "", _FITTED
    )
    suspected: float = threshold(
        0.75, "confidence below which a finding is suspected, not claimed", "", "chosen"
    )
