"""Parquet files, a batch of rows at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet

from pdoik.errors import LoadError

from ..recording import FloatArray
from .arrow_numbers import numbers
from .kinds import register
from .log import Column, Log


@register
class Parquet(Log):
    """Columns of numbers or time stamps."""

    kind = "Parquet"
    suffixes = (".parquet", ".pq")
    magic = (b"PAR1",)

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        self.notes = []
        self._name = name
        try:
            self._file = pa.parquet.ParquetFile(path)
        except (pa.ArrowInvalid, OSError) as error:
            raise LoadError(f"{name}: no Parquet file: {error}") from error
        self.columns = tuple(Column(name=each) for each in self._file.schema_arrow.names)
        self.rows = float(self._file.metadata.num_rows)

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        try:
            for batch in self._file.iter_batches(columns=list(columns)):
                yield numbers(batch, columns, self._name)
        except (pa.ArrowInvalid, OSError) as error:
            raise LoadError(f"{self._name}: cannot be read on: {error}") from error

    def close(self) -> None:
        self._file.close()
