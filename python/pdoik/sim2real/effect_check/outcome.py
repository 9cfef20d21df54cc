"""What one check of an effect says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Status = Literal["pass", "fail", "not applicable"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """The outcome of one check; without a figure `measured` and `limit` are NaN."""

    check: str
    status: Status
    measured: float = math.nan
    limit: float = math.nan
    words: str = ""  # what was measured, or why it failed or cannot be checked


def at_most(check: str, measured: float, limit: float, words: str) -> Outcome:
    """It passes where the figure is a number, and not above the limit."""
    good = math.isfinite(measured) and measured <= limit
    return Outcome(
        check=check,
        status="pass" if good else "fail",
        measured=measured,
        limit=limit,
        words=words,
    )


def none_of(check: str, wrong: list[str], words: str) -> Outcome:
    """It passes where nothing is wrong; the figure is how much is."""
    return Outcome(
        check=check,
        status="fail" if wrong else "pass",
        measured=float(len(wrong)),
        limit=0.0,
        words="; ".join(wrong) or words,
    )


def not_applicable(check: str, why: str) -> Outcome:
    """The effect has nothing that this check is about."""
    return Outcome(check=check, status="not applicable", words=why)
