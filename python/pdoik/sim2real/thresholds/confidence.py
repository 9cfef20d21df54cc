"""How sure a finding is, by what speaks for it."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold

_FITTED = (
    "bench/sim2real/diagnosis/confidence.py: logistic regression on concealed worlds of development"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfidenceThresholds(Group):
    """Weights of the log odds that a finding is there, and what is made of them."""

    base: float = threshold(2.27, "log odds where half of what is left is gained", "", _FITTED)
    odds: float = threshold(0.0, "per logarithm of one and the posterior log odds", "", _FITTED)
    gain: float = threshold(
        0.46,
        "per log odds of the gain: its share of what is left on left-out sessions",
        "",
        _FITTED,
    )
    event: float = threshold(
        -2.5,
        "of what happens once: the best of hundreds of windows is often good",
        "",
        "chosen; -3.0 fits best, on 11 events only",
    )
    unsupported: float = threshold(0.9, "confidence of what is wrong with a channel", "", _FITTED)
    suspected: float = threshold(
        0.75, "confidence below which a finding is suspected, not claimed", "", "chosen"
    )
