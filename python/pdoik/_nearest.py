"""Names like one that is not known, for messages."""

from __future__ import annotations

import difflib
from collections.abc import Collection


def nearest(name: str, known: Collection[str], count: int = 3) -> str:
    """The names most like `name`, as the end of a message: "; nearest: 'a', 'b'" or ""."""
    low = {each.lower(): each for each in known}
    found = difflib.get_close_matches(name.lower(), low, n=count, cutoff=0.5)
    return f"; nearest: {', '.join(repr(low[each]) for each in found)}" if found else ""
