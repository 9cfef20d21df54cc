"""What links carry, told again: the compiled solver and tracker keep it and do not give it back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from pdoik._core import Shape


class Carried(NamedTuple):
    """One call of `attach`."""

    link: str
    shapes: tuple[Shape, ...]
    may_touch: tuple[str, ...]


class Carries:
    """Of a Solver and a Tracker: `attach` and `detach` are noted in `carried`."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        self._carried: list[Carried] = []

    def __repr__(self) -> str:
        # A debugger shows what refused its arguments too: nothing is there yet.
        made = "_carried" in self.__dict__
        return self._told() if made else f"<{type(self).__name__} that was not made>"

    def _told(self) -> str:
        """It in a line."""
        raise NotImplementedError

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
