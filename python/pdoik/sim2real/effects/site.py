"""Where an effect is and how large, by names, as a simulation wants it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..simulation import Part


@dataclass(frozen=True, slots=True, kw_only=True)
class Site:
    """Where one finding is, and its values; `site["level"]` is a parameter, which must exist."""

    joints: tuple[str, ...] = ()  # it acts on each; of a coupling the moved one, then its motor's
    links: tuple[str, ...] = ()
    window: tuple[float, float] | None = None  # of the recordings it acts in [s]
    recordings: tuple[str, ...] = ()  # () for all
    variant: str = ""  # what it is of, where the effect may be of several
    values: Mapping[str, float]

    def __getitem__(self, parameter: str) -> float:
        return float(self.values[parameter])

    def get(self, parameter: str) -> float:
        """A parameter, 0 where it is not there."""
        return float(self.values.get(parameter, 0.0))

    @property
    def link(self) -> str:
        """The first link; "" for the last joint's."""
        return self.links[0] if self.links else ""

    def each(self, make: Callable[[str], Part]) -> tuple[Part, ...]:
        """A part for each joint."""
        return tuple(make(joint) for joint in self.joints)
