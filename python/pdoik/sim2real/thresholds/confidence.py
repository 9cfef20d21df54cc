"""How sure a finding is, by what speaks for it."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold

_FITTED = (
    "bench/sim2real/diagnosis/confidence.py: logistic regression on concealed worlds of development"
)
_ON = "the same on opened worlds of bench/sim2real/machines"


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfidenceThresholds(Group):
    """Weights of the log odds that a finding is there, and what is made of them."""

    there: float = threshold(
        0.32, "log odds of a cause that few machines have, barely there, gaining half", "", _ON
    )
    odds: float = threshold(0.30, "per logarithm of one and the posterior log odds", "", _ON)
    explains: float = threshold(
        0.16,
        "per log odds of the gain: its share of what all else leaves on rows it was not fitted to",
        "",
        _ON,
    )
    many: float = threshold(2.90, "of what many machines have", "", _ON)
    all: float = threshold(3.01, "of what every machine has", "", _ON)
    base: float = threshold(
        2.16, "log odds of a law's error or an event, as large as what is left", "", _FITTED
    )
    size: float = threshold(
        0.13, "per logarithm of its part over what nothing explains", "", _FITTED
    )
    gain: float = threshold(
        0.36,
        "per log odds of the gain: its share of what all else leaves on rows it was not fitted to",
        "",
        _FITTED,
    )
    event: float = threshold(
        -2.5,
        "of what happens once: the best of hundreds of windows is often good",
        "",
        "chosen; -1.7 fits best, on a dozen events only",
    )
    unsupported: float = threshold(0.9, "confidence of what is wrong with a channel", "", _FITTED)
