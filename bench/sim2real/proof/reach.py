"""What is asked of the diagnosis, and whether it was reached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from bench.common.intervals import wilson
from bench.common.markdown import markdown_table


@dataclass(frozen=True, slots=True)
class Asked:
    """One threshold; a share unless it says otherwise."""

    what: str
    column: str
    of: str  # which studies, see `chosen`
    least: float | None = None
    most: float | None = None


ASKED = (
    Asked("plain: named first", "named", "plain", least=0.92),
    Asked("plain: named or equivalent", "listed", "plain", least=0.97),
    Asked("plain: placed", "placed", "plain", least=0.97),
    Asked(
        *("all ways, poor by its right answer: named or equivalent", "listed_or_right", "effects"),
        least=0.85,
    ),
    Asked("all ways, poor by its right answer: placed", "placed_or_right", "effects", least=0.90),
    Asked("all ways but poor: named or equivalent", "listed", "seen", least=0.85),
    Asked("all ways but poor: placed", "placed", "seen", least=0.90),
    Asked("false alarms on clean studies", "alarm", "clean", most=0.02),
    Asked("clean studies", "count", "clean", least=100),
    Asked("unknown recognised", "right", "outside", least=0.90),
    Asked("true parameters within the 95 % interval", "coverage", "seen", least=0.90, most=0.98),
    Asked("held-out residual after, of the true model's (median)", "over_true", "seen", most=1.15),
)


def chosen(studies: pd.DataFrame, of: str) -> pd.DataFrame:
    """Studies by a word: effects, seen (effects that motion shows), plain, or a group's name."""
    hidden = studies[studies.group == "effect"]
    chosen = {"effects": hidden, "seen": hidden[hidden.hide != "poor"]}
    chosen["plain"] = hidden[hidden.hide == "plain"]
    return chosen[of] if of in chosen else studies[studies.group == of]


def reached(studies: pd.DataFrame, asked: Asked) -> tuple[float, str, int]:
    """The value, its 95 % interval in words, and of how many."""
    some = chosen(studies, asked.of)
    if asked.column == "count":
        return float(len(some)), "", len(some)
    if asked.column == "over_true":
        return median(some.over_true)
    if asked.column == "coverage":
        successes, total = int(some.inside.sum()), int(some.intervals.sum())
    else:
        successes, total = int(some[asked.column].sum()), len(some)
    low, high = wilson(successes, total)
    return (successes / total if total else np.nan), f"{low:.3f} to {high:.3f}", total


def median(values: pd.Series[float]) -> tuple[float, str, int]:
    """The median, its 95 % interval by order statistics, and of how many."""
    known = values.dropna().to_numpy(float)
    if len(known) == 0:
        return np.nan, "", 0
    interval = stats.quantile_test(known, q=float(np.median(known)), p=0.5).confidence_interval()
    known_ends = np.isfinite([interval.low, interval.high]).all()  # not of five or fewer
    words = f"{interval.low:.3f} to {interval.high:.3f}" if known_ends else ""
    return float(np.median(known)), words, len(known)


def verdict(value: float, asked: Asked) -> str:
    """PASS or MISS by the value itself; nothing of it, no word."""
    if not np.isfinite(value):
        return "none"
    low = asked.least is None or value >= asked.least
    return "PASS" if low and (asked.most is None or value <= asked.most) else "MISS"


def scores_of(studies: pd.DataFrame) -> dict[str, Any]:
    """What is asked and how it came out, as the record keeps it."""
    scores = {}
    for asked in ASKED:
        value, interval, total = reached(studies, asked)
        scores[asked.what] = {
            "value": round(value, 4) if total else None,
            "interval95": interval,
            "of": total,
            "verdict": verdict(value, asked),
        }
    return scores


def reach_table(studies: pd.DataFrame) -> str:
    rows = []
    for asked in ASKED:
        value, interval, total = reached(studies, asked)
        bounds = [f"at least {asked.least:g}"] if asked.least is not None else []
        bounds += [f"at most {asked.most:g}"] if asked.most is not None else []
        shown = f"{value:.3f}" if asked.column != "count" else f"{value:.0f}"
        row = [asked.what, " and ".join(bounds), shown, interval, total, verdict(value, asked)]
        rows.append(row)
    return markdown_table(["", "asked", "measured", "95 % interval", "of", ""], rows)
