"""How a study says that logs are read, for whoever reads further logs of its machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .names import ColumnsKey, columns_key
from .units import Units, units_from


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """The study's `columns:`, `units:` and `ignore:`."""

    columns: Mapping[str, str] = field(default_factory=dict)  # source by target
    units: Mapping[str, str] = field(default_factory=dict)  # by channel or column
    ignore: tuple[str, ...] = ()

    @classmethod
    def of_content(cls, content: Mapping[str, Any], source: str) -> Reading:
        """The reading that a study's keys say.

        Raises:
            LoadError: they are not as expected.
        """
        return cls(
            columns=columns_key(content.get("columns"), f"{source}: columns").sources,
            units=dict(units_from(content.get("units"), source).named),
            ignore=tuple(str(each) for each in content.get("ignore") or ()),
        )

    @property
    def key(self) -> ColumnsKey:
        """The key of the columns; other logs of the machine may lack some of them."""
        return ColumnsKey(sources=dict(self.columns), optional=True)

    @property
    def said_units(self) -> Units:
        """The units of the columns."""
        return Units(dict(self.units))

    @property
    def note(self) -> str:
        """What of it decides how a log is understood, in words; "" where nothing does."""
        said = [f"{target} from {source!r}" for target, source in self.columns.items()]
        said += [f"{channel} in {unit}" for channel, unit in self.units.items()]
        return f"read as the study says: {', '.join(said)}" if said else ""
