"""How a study's logs are read, for whoever reads further logs of the same machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pdoik.errors import LoadError

from . import keys as study_keys
from .names.columns_key import ColumnsKey, columns_key
from .units import Units, units_from


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """The study's `columns:`, `units:` and `ignore:`."""

    columns: Mapping[str, str] = field(default_factory=dict)  # source by target
    units: Mapping[str, str] = field(default_factory=dict)  # by channel or column
    ignore: tuple[str, ...] = ()

    @classmethod
    def of_study(cls, path: str | Path) -> Reading:
        """What a study's YAML says; its recordings are not read.

        Raises:
            LoadError: it is no study, or these keys are not as expected.
        """
        path = Path(path)
        if not path.is_file():
            raise LoadError(f"{path}: expected a study's YAML file with 'columns:'")
        content = study_keys.read_keys(path)
        return cls.of_content(content, path.name)

    @classmethod
    def of_content(cls, content: Mapping[str, Any], source: str) -> Reading:
        """Of the keys of a study, or of a model.

        Raises:
            LoadError: they are not as expected.
        """
        return cls(
            columns=columns_key(content.get("columns"), f"{source}: columns").sources,
            units=dict(units_from(content.get("units"), source).named),
            ignore=study_keys.names(content.get("ignore"), "ignore") or (),
        )

    def content(self) -> dict[str, Any]:
        """As `of_content` takes it."""
        return {
            "columns": dict(self.columns),
            "units": dict(self.units),
            "ignore": list(self.ignore),
        }

    @property
    def key(self) -> ColumnsKey:
        """Of the columns; other logs of the machine may lack some of them."""
        return ColumnsKey(sources=dict(self.columns), optional=True)

    @property
    def said_units(self) -> Units:
        """Of the columns."""
        return Units(dict(self.units))

    @property
    def note(self) -> str:
        """What of it decides how a log is understood, in words; "" where nothing does."""
        said = [f"{target} from {source!r}" for target, source in self.columns.items()]
        said += [f"{channel} in {unit}" for channel, unit in self.units.items()]
        return f"read as the study's logs: {', '.join(said)}" if said else ""
