"""Intervals of what is random: shares and medians."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import binomtest


def wilson(successes: int, total: int) -> tuple[float, float]:
    """95% interval of a share (Wilson's)."""
    if total == 0:
        return 0.0, 1.0
    interval = binomtest(successes, total).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def share(outcomes: Sequence[bool]) -> str:
    """A share with its 95% interval, as .875 [.83, .91]."""
    successes, total = int(np.sum(outcomes)), len(outcomes)
    low, high = wilson(successes, total)
    value = successes / total if total else float("nan")
    return f"{_short(value, 3)} [{_short(low, 2)}, {_short(high, 2)}]"


def _short(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    return text[1:] if text.startswith("0.") else text


def duration(seconds: float) -> str:
    """A time with three figures and the unit that suits it."""
    for unit, scale in (("us", 1e-6), ("ms", 1e-3), ("s", 1.0)):
        if seconds < 999.5 * scale or unit == "s":
            value = seconds / scale
            return f"{value:.0f} {unit}" if value >= 99.5 else f"{value:.3g} {unit}"
    raise AssertionError
