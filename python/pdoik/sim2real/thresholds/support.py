"""What a finding must bring where neither its figures nor its shape were learnt."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class SupportThresholds(Group):
    """Of accepted terms, each learnt anew without one session after the other."""

    least_elsewhere: float = threshold(
        0.02, "share of a term's squared column that a session, and the rest of them, must hold"
    )
    alone_t: float = threshold(
        8.0, "Wald statistic of what acts in one session only, and rests on that", "s.e."
    )
    alone_size: float = threshold(3.0, "root mean square of the same where it acts", "sigma")
