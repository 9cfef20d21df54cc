"""The amount at which something is just seen, where it is not in proportion to its amount."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

_STEPS = 12  # from amount to amount at most


def bisected(
    clarity: Callable[[float], float], tried: Sequence[float], begin: float, most: float
) -> float:
    """The amount of clarity 1, of what is not in proportion to its amount; inf for none.

    Goes along the amounts that are tried, else by factors of two, and below them by these.
    """
    amount, here = begin, clarity(begin)
    up = here < 1.0
    for _ in range(_STEPS):
        other = _next(tried, amount, up)
        if other is None or other > most:
            return np.inf
        there = clarity(other)
        if (there < 1.0) != up:
            return _between(amount, here, other, there)
        amount, here = other, there
    return np.inf if up else amount


def _next(tried: Sequence[float], amount: float, up: bool) -> float | None:
    """The next amount, larger or smaller; None beyond the largest that is tried."""
    if up:
        return min((each for each in tried if each > amount), default=None if tried else 2 * amount)
    return max((each for each in tried if each < amount), default=0.5 * amount)


def _between(one: float, at_one: float, other: float, at_other: float) -> float:
    """The amount of clarity 1 between two, on a line over logarithms."""
    low, high = np.log(max(at_one, 1e-6)), np.log(max(at_other, 1e-6))
    share = 0.0 if high == low else -low / (high - low)
    return float(one * (other / one) ** share)
