"""Joints' names out of the columns' own, where neither log nor user nor robot names the joints."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..logs import Column
from . import words
from .meaning import quantity_of
from .tokens import spelling


def joints_in(columns: Sequence[Column]) -> tuple[str, ...]:
    """What is left of the names of positions without the words for them, as it is written.

    Of `shoulder_pan_pos`, `shoulder_pan_vel` and `battery_current` it is `shoulder_pan`: what has
    no position is no joint.
    """
    found = (_joint_of(column) for column in columns if column.index is None)
    return tuple(dict.fromkeys(each for each in found if each is not None))


def _joint_of(column: Column) -> str | None:
    """The joint whose position a column is, by its name; None where it says none."""
    spelled = spelling(column.name)
    tokens = spelled.tokens
    found = quantity_of(tokens, column.unit or spelled.unit)
    if found is None or words.CHANNELS_OF.get((found.quantity, found.commanded)) != "q":
        return None
    named = [k for k in found.left if not tokens[k].text.isdigit()]
    if not named:
        return None
    components = {tokens[k].component for k in named}
    kept = [k for k in found.left if tokens[k].component in components]
    span = [each.text for each in tokens[kept[0] : kept[-1] + 1]]
    written = re.search(r"[\W_]*".join(map(re.escape, span)), column.name, re.IGNORECASE)
    apart = found.used & set(range(kept[0], kept[-1] + 1))
    return "_".join(tokens[k].text for k in kept) if apart or written is None else written.group()
