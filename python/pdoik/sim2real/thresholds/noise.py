"""What counts as noise, and how rows are divided to find it."""

from __future__ import annotations

from dataclasses import dataclass

from .threshold import Group, threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseThresholds(Group):
    """Thresholds of the balances by which everything is compared."""

    model_error: float = threshold(
        0.003, "share of a torque's own size below which nothing is claimed: rounding, filters"
    )
    rounding: float = threshold(
        1e-3, "share of a torque's own size below which a log without noise is no better known"
    )
    fit_error: float = threshold(
        0.01, "share of a mismatch's own size to which the catalogue's laws are taken to be exact"
    )
    block: float = threshold(
        1.5, "length of the bootstrap's blocks: longer than residuals remember", "s"
    )
    longest: float = threshold(
        600.0, "recorded time to fit beyond which excerpts are used, spread over all of it", "s"
    )
    shortest: float = threshold(120.0, "time that excerpts last together at least", "s")
    most_rows: int = threshold(
        50_000, "rows of all joints to fit beyond which excerpts are used, as balances are thinned"
    )
    judged_share: float = threshold(0.5, "the same of recordings that only judge, as a share of it")
    folds: int = threshold(4, "parts of cross-validation: recordings, or long stretches of few")
    lowest_cutoff: float = threshold(5.0, "lowest cut-off of the balances that is chosen", "Hz")
    highest_cutoff: float = threshold(20.0, "highest cut-off that is chosen", "Hz")
    cutoff_of_rate: float = threshold(0.11, "highest cut-off as a share of the sampling rate")
    still_speed: float = threshold(
        2e-3, "speed below which a joint is still, whatever its noise", "rad/s"
    )
    least_range: float = threshold(0.05, "range within which a joint has not moved", "rad or m")
    least_moving: float = threshold(0.1, "share of the time that a joint must move to be judged")
