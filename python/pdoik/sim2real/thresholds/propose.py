"""When a proposed motion counts as settling what a diagnosis leaves open."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposeThresholds(Group):
    """Thresholds of what is expected along a motion that was not made yet."""

    enough: float = threshold(0.9, "confidence from which a finding needs no further motion")
    decisive: float = threshold(
        10.0,
        "expected log likelihood ratio of two causes, from which more is not sought",
        "",
        "odds of 20 000 to 1",
    )
    gain: float = threshold(
        0.8,
        "share of what is left where a finding acts, from which more is not sought",
        "",
        "well above what confidence.gain asks for `enough`",
    )
    known: float = threshold(
        9.0,
        "decrease of the cost in the recordings from which a rival's figures are known",
        "",
        "three standard errors",
    )
    doubt: float = threshold(
        1.28,
        "standard deviations that a ratio is assumed to fall short of what is expected",
        "s.e.",
        "one motion of ten falls shorter",
    )
