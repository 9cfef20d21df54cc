"""What is hidden, as the truth tells it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """One cause: its name, its place, its figures in the catalogue's names and units."""

    effect: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    feet: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)
