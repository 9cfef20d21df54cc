"""When a candidate is looked for, and when another takes its place."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectionThresholds(Group):
    """Of harmonics, rivals, tilted bases and causes that joints share."""

    harmonic_power: float = threshold(
        20.0, "power of a harmonic in what is left, from which its effects are tried", "sigma^2"
    )
    harmonic_rows: int = threshold(50, "rows from which a harmonic can be found", "rows")
    rival_gain: float = threshold(
        0.8, "share of a term's gain that another must have in training to be held against it"
    )
    tilt: float = threshold(
        0.02, "angle between two leanings of the base that matters to what bodies weigh", "rad"
    )
    shared_by: float = threshold(
        0.6, "share of the moving joints that must show a delay, lag or skew to give it to all"
    )
