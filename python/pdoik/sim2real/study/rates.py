"""How finely recordings are looked at: the cut-off of balances, and their rows."""

from __future__ import annotations

from ..thresholds import NoiseThresholds

ROWS = 3.0
"""Rows of a balance for each period of its cut-off."""


def highest_cutoff(limits: NoiseThresholds, rate: float) -> float:
    """The highest cut-off of balances [Hz] for recordings sampled at `rate` [Hz]."""
    return min(limits.highest_cutoff, limits.cutoff_of_rate * rate)
