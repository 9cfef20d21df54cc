"""What is known of a log's columns beforehand, and what they are settled to be."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from ..logs import Column
from .columns_key import ColumnsKey
from .mujoco_order import MujocoOrder

SHOWN = 8
"""Names in one message."""

ALONG_THE_ARM = "the joints' order from the base"
"""How numbers are understood where nobody names their joints."""

IN_THE_LOG = "their order in the log, which names no joints"
"""How numbers are understood where not even a robot is known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """What is known of a log's columns before it is opened."""

    joints: tuple[str, ...] | None = None  # whose channels are read, in this order
    others: tuple[str, ...] = ()  # of the robot's description, where nobody names them
    arm: tuple[str, ...] = ()  # those of them that follow one another from the base
    key: ColumnsKey = field(default_factory=ColumnsKey)  # of `columns:`
    ignore: Collection[str] = ()
    numbered: bool = False  # whether joints that nobody names are joint1, joint2 ...
    order: MujocoOrder = field(default_factory=MujocoOrder)


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """A column that is read."""

    column: Column
    target: str  # what it is called from here on: "q.elbow"
    unit: str = ""  # of `units.KNOWN`, if its name says so
    factor: float = 1.0
    exact: bool = False  # it was called that already
    by_order: str = ""  # the order by which its number alone says whose it is, in words


def listed(names: Collection[str]) -> str:
    """Names for a message, not too many."""
    shown = list(names)[:SHOWN]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
