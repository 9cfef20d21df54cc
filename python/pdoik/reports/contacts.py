"""Rules of contact as a report has them, and what they want of two things."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from typing import Any

from .._core import ContactRule
from .values import Entry, plain

_PIECE = re.compile(r"(.+)/\d+")


def rule_entry(rule: ContactRule) -> dict[str, Any]:
    """What `read_rule` reads."""
    return {
        "one": rule.one,
        "other": rule.other,
        "clearance": plain(rule.clearance),
        "optional": rule.optional,
    }


def read_rule(entry: Entry) -> ContactRule:
    """The same rule again.

    Raises:
        LoadError: Names the entry and what is wrong with it.
    """
    one, other = entry["one"].text(), entry["other"].text()
    optional, clearance = entry["optional"].boolean(), entry["clearance"]
    try:
        if clearance.value is None:
            return ContactRule(one, other, allowed=False, optional=optional)
        return ContactRule(one, other, clearance=clearance.number(), optional=optional)
    except ValueError as error:
        if type(error) is not ValueError:  # it names its entry already
            raise
        raise entry.wrong(str(error)) from error


def read_allowed(entry: Entry) -> ContactRule:
    """Rule of older reports: a link, a shape and perhaps a depth."""
    parts = entry.items()
    if len(parts) not in (2, 3):
        raise entry.expected("a link, a shape and perhaps a depth")
    depth = -parts[2].number() if len(parts) == 3 else -math.inf
    return ContactRule(parts[0].text(), parts[1].text(), clearance=depth)


class Wanted:
    """What distance is wanted of two things, by rules: what the compiled library is judged by.

    Args:
        ignored: Pairs of links that may touch.
        rules: In their order.
    """

    def __init__(self, ignored: Iterable[tuple[str, str]], rules: Sequence[ContactRule]) -> None:
        said: list[tuple[str, str, float | None]] = [(*pair, -math.inf) for pair in ignored]
        said += [(rule.one, rule.other, rule.clearance) for rule in rules]
        # Of as many exact names the last counts, and those with more before those with fewer.
        self._said = [
            each
            for exact in (2, 1, 0)
            for each in said[::-1]
            if sum(_is_exact(name) for name in each[:2]) == exact
        ]

    def of(self, one: Sequence[str], other: Sequence[str], default: float) -> float:
        """Least distance of two things, each by the names of the links it sits on [m].

        Of two links that a hull spans what lets come nearer counts, if anything does.
        """
        each = [self._of_names(a, b, default) for a in one for b in other]
        return min(each) if min(each) < default else max(each)

    def _of_names(self, one: str, other: str, default: float) -> float:
        for a, b, clearance in self._said:
            if (_means(a, one) and _means(b, other)) or (_means(a, other) and _means(b, one)):
                return default if clearance is None else clearance
        return default


def _is_exact(name: str) -> bool:
    return not set("*?") & set(name)


def _means(name: str, thing: str) -> bool:
    """Whether a name or a pattern means a thing, or the object that it is a piece of."""
    piece = _PIECE.fullmatch(thing)
    names = [thing] if piece is None else [thing, piece[1]]
    if _is_exact(name):
        return name in names
    pattern = name.replace("[", "[[]")  # which is no class of letters here
    return any(fnmatchcase(each, pattern) for each in names)
