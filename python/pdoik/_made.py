"""A `__repr__` for solvers and trackers that may not have been made."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def once_made(described: Callable[[Any], str]) -> Callable[[Any], str]:
    """A `__repr__` that says so where nothing was made: debuggers show what refused its arguments.

    Whatever asks the compiled part then would read what is not there. Its class sets attributes
    only once that is made.
    """

    def shown(self: Any) -> str:
        if self.__dict__:
            return described(self)
        return f"<{type(self).__name__} that was not made>"

    return shown
