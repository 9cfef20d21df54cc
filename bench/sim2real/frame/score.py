"""How findings are held against what is hidden: the counting that all scores share.

What counts as right is said by each kind of worlds: its score.py gives tests of a finding against a
hidden cause. Here is what is done with them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from bench.common.arrays import BoolArray, FloatArray

Content = Mapping[str, Any]  # of JSON: a truth, a finding, a diagnosis
Test = Callable[[Content], bool]  # of a finding

MOST_EQUIVALENTS = 3  # of a finding that count as named by it


def as_diagnosis(said: Content) -> dict[str, Any]:
    """A result of one.py in the shape of diagnosis.json; an error is its verdict."""
    if "diagnosis" in said:
        return dict(said["diagnosis"])
    return {"verdict": f"error: {said['error']}", "findings": [], "joints": {}, "notes": []}


def confidence(finding: Content) -> float:
    """As stated; results of before confidences were stated are sure."""
    return float(finding.get("confidence", 1.0))


def rank(findings: Sequence[Content], test: Test) -> int:
    """The place, from 1, of the first finding that passes a test; 0 where none does."""
    return next((k for k, finding in enumerate(findings, start=1) if test(finding)), 0)


def alternatives(finding: Content, most: int | None = MOST_EQUIVALENTS) -> Iterator[Content]:
    """The finding, and what it lists as explaining the same."""
    yield finding
    yield from finding.get("equivalents", [])[:most]


def agrees(estimate: Content, true: float, relative: float) -> bool:
    """Whether a figure's 95 % interval holds the true one, or it is as near as that."""
    low, high = estimate["interval95"]
    return bool(low <= true <= high or abs(estimate["value"] - true) <= relative * abs(true))


def error_of(estimate: Content, true: float, *, turns: bool = False) -> float:
    """An estimate's error; an angle's within half a turn."""
    error = float(estimate["value"]) - true
    return (error + np.pi) % (2.0 * np.pi) - np.pi if turns else error


def covered(estimate: Content, error: float) -> bool:
    """Whether an error is within half the width of the 95 % interval."""
    low, high = estimate["interval95"]
    return bool(abs(error) <= 0.5 * (high - low))


def by_confidence(stated: FloatArray, edges: Sequence[float]) -> Iterator[tuple[str, BoolArray]]:
    """The findings between two edges, (N,), by a name of these; the last edge is included."""
    for low, high in pairwise(edges):
        inside = (stated >= low) & ((stated < high) | (high == edges[-1]))
        if inside.any():
            yield f"{low:g} to {min(high, 1.0):g}", inside
