"""Where a replay is not what the report says, and what may be why, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .question import ANSWER, EFFORT, FOUND, LATER, OF_STEPS


def of_answers(was: Mapping[str, Any], now: Mapping[str, Any], *, counts: bool) -> list[str]:
    """What is not the same to the bit, in words.

    Args:
        was: The report's answer.
        now: This process's.
        counts: Compare effort, too; in a batch it depends on which thread solved what before.
    """
    found = []
    later = [name for name in LATER if name in was]
    for name in (*ANSWER, *later, *(EFFORT if counts else ()), *OF_STEPS):
        a, b = was.get(name), now.get(name)
        if name == "q":
            a, b = np.asarray(a), np.asarray(b)
            if a.tobytes() != b.tobytes():
                found.append(f"q differs by up to {np.abs(a - b).max():.3g}")
        elif isinstance(a, np.ndarray):
            if a.tobytes() != np.asarray(b).tobytes():
                found.append(f"{name} was {a.tolist()}, is {np.asarray(b).tolist()}")
        elif a != b and not (a != a and b != b):  # NaN
            found.append(f"{name} was {a!r}, is {b!r}")
    return found


def of_found(was: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """The same of all solutions, in which the answers themselves are not looked at."""
    if len(was["turns"]) != len(now["turns"]):
        return [f"there were {len(was['turns'])} solutions, there are {len(now['turns'])}"]
    names = [name for name in FOUND if name != "time"]
    return [f"{n} was {was[n]!r}, is {now[n]!r}" for n in names if was[n] != now[n]]


def reasons_for(by: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """What of the two builds and machines is not the same."""
    reasons = []
    if by.get("simd") != here["simd"]:
        simd = by.get("simd")
        reasons.append(
            f"other instructions: {simd} there, {here['simd']} here; PDOIK_SIMD={simd} takes those"
        )
    if by.get("core") != here["core"]:
        versions = f"pdoik {by.get('pdoik')} there, {here['pdoik']} here"
        reasons.append(f"another build: {versions}, compiled modules differ")
    if by.get("processor") != here["processor"]:
        reasons.append(f"another processor: {by.get('processor')} there, {here['processor']} here")
    return reasons
