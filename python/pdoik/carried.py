"""What links carry, told again: the compiled solver and tracker keep it and do not give it back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from pdoik._core import Shape


class Carried(NamedTuple):
    """One call of `attach`."""

    link: str
    shapes: tuple[Shape, ...]
    may_touch: tuple[str, ...]


def once_made(described: Callable[[Any], str]) -> Callable[[Any], str]:
    """A `__repr__` that says so where nothing was made: debuggers show what refused its arguments.

    Whatever asks the compiled part then would read what is not there.
    """

    def shown(self: Any) -> str:
        made = "_carried" in self.__dict__
        return described(self) if made else f"<{type(self).__name__} that was not made>"

    return shown


class Carries:
    """Of a Solver and a Tracker: `attach` and `detach` are noted in `carried`."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        self._carried: list[Carried] = []

    @property
    def carried(self) -> tuple[Carried, ...]:
        """What links carry, in the order it was attached."""
        return tuple(self._carried)

    def attach(self, link: str, shapes: Sequence[Shape], may_touch: Sequence[str] = ()) -> None:
        super().attach(link, shapes, may_touch)  # type: ignore[misc]
        self._carried.append(Carried(link, tuple(shapes), tuple(may_touch)))

    def detach(self, link: str | None = None) -> None:
        super().detach(link)  # type: ignore[misc]
        self._carried = [each for each in self._carried if link not in (None, each.link)]
