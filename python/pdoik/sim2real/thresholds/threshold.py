"""A number that decides what a diagnosis says, with what it means and where it comes from."""

from __future__ import annotations

from dataclasses import Field, field, fields
from math import isfinite
from typing import Any


def threshold(value: float, meaning: str, unit: str = "", source: str = "chosen") -> Any:
    """A field of a group of thresholds.

    Args:
        value: its default.
        meaning: what it bounds, in words.
        unit: SI, `sigma` (the noise of a balance), `s.e.` (standard errors), or "" for a share, a
            factor or a count.
        source: a reference, or how it was chosen.
    """
    return field(default=value, metadata={"meaning": meaning, "unit": unit, "source": source})


class Group:
    """Thresholds of one stage: a frozen dataclass of numbers."""

    def __post_init__(self) -> None:
        """Only finite numbers, whole ones where the default is whole.

        Raises:
            ValueError: one of them is something else.
        """
        for each in numbers_of(self):
            value = getattr(self, each.name)
            whole = isinstance(each.default, int)
            if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
                expected = "a whole number" if whole else "a number"
                raise ValueError(f"{each.name} is {value!r}; expected {expected}")
            if not isfinite(value):
                raise ValueError(f"{each.name} is {value!r}; expected a finite number")


def numbers_of(group: Group) -> tuple[Field[Any], ...]:
    """The fields of a group."""
    return fields(group)  # type: ignore[arg-type]  # every group is a dataclass
