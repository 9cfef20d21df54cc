"""When an effect is one of a part of time or of positions only."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class GateThresholds(Group):
    """Of gated terms, held against all that was accepted of their kind at the joint."""

    least_left: float = threshold(
        1.2, "root mean square of what the joint shows without such effects", "sigma"
    )
    explains: float = threshold(
        0.75, "share that a gated effect must explain of what the joint shows above the noise"
    )
    promising: float = threshold(
        0.4, "share of the same that its column alone must explain to be looked at closely"
    )
    better: float = threshold(
        0.05, "share of the same by which it must be better than what it replaces"
    )
    better_t: float = threshold(
        2.0, "errors, by blocks, by which it must be better; a gate may hold few", "s.e."
    )
    least_inside: float = threshold(0.02, "share of an effect's squared column that a gate holds")
    onset_explains: float = threshold(
        0.1, "share of what is left at a joint that an effect since some moment must explain"
    )
    onset_t: float = threshold(
        5.0, "Wald statistic of such an effect", "s.e.", "some hundred moments are looked at"
    )
    onset_better: float = threshold(
        0.3, "share by which a moment inside a recording must explain more than any border"
    )
    onset_away: float = threshold(2.0, "least time between such a moment and a border", "s")
    most_inside: float = threshold(0.85, "the same, at most: a gate that holds more is none")
