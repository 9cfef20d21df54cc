"""What lets a session say something of a term."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SupportThresholds(Group):
    """Of accepted terms, each learnt anew without one session after the other."""

    least_elsewhere: float = threshold(
        0.02, "share of a term's squared column that a session, and the rest of them, must hold"
    )
    fewest_told: int = threshold(
        3, "sessions that a study tells of, from which whole ones are left out", "sessions"
    )
