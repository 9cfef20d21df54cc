"""CSV files, read in pieces: a log may be larger than the memory."""

from __future__ import annotations

import gzip
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO, cast

import pyarrow as pa
import pyarrow.csv

from pdoik.errors import LoadError

from ..recording import FloatArray
from .arrow_numbers import numbers
from .csv_form import CsvForm
from .kinds import register
from .log import Column, Log

_BLOCK = 8 << 20  # bytes parsed at a time
_RAGGED = 0.01  # share of rows with another number of cells that is still a log


@register
class CsvText(Log):
    """A line of names, then a line of numbers for each row."""

    kind = "CSV"
    suffixes = (".csv", ".tsv", ".txt", ".csv.gz", ".tsv.gz", ".txt.gz")

    def __init__(self, path: Path, name: str, told: Mapping[str, Any]) -> None:
        self.notes = []
        self._path, self._name = path, name
        try:
            with self._open() as file:
                head = file.readline()
                second = file.readline()
            self.rows = self._count()
        except (OSError, UnicodeDecodeError, EOFError) as error:
            raise LoadError(f"{name}: no CSV text: {error}") from error
        self._form = CsvForm.of_lines(name, head, second)
        self.columns = tuple(Column(name=each) for each in self._form.header)

    def _open(self) -> TextIO:
        if self._path.suffix == ".gz":
            return cast(TextIO, gzip.open(self._path, "rt", encoding="utf-8-sig"))
        return self._path.open(encoding="utf-8-sig")

    def _count(self) -> float:
        """About how many rows the file has, from its size and the first lines."""
        size = self._path.stat().st_size * (1 if self._path.suffix != ".gz" else 3)
        with self._open() as file:
            lines = [len(line) for _, line in zip(range(1001), file, strict=False)][1:]
        return size * len(lines) / sum(lines) if lines else 0.0

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        ragged = 0

        def skip(_row: Any) -> str:
            nonlocal ragged
            ragged += 1
            return "skip"

        total = 0
        try:
            with pa.csv.open_csv(
                pa.input_stream(str(self._path), compression="detect"),
                **self._form.options(list(columns), skip, skip=1, block=_BLOCK),
            ) as reader:
                for batch in reader:
                    total += batch.num_rows
                    yield numbers(batch, columns)
        except (pa.ArrowInvalid, OSError) as error:
            raise LoadError(f"{self._name}: {_worded(str(error), columns)}") from error
        if ragged > max(1, _RAGGED * total):
            raise LoadError(
                f"{self._name}: {ragged} of {ragged + total} rows have another number of cells than"
                f" the header ({len(self._form.header)})"
            )
        if ragged:
            self.notes.append(f"{ragged} incomplete row(s) left out")


def _worded(message: str, columns: Sequence[str]) -> str:
    """Arrow's message with the column's name for its number."""
    head, colon, rest = message.partition(": ")
    number = head.removeprefix("In CSV column #")
    if colon and number.isdigit() and int(number) < len(columns):
        return f"column {columns[int(number)]!r}: {rest}"
    return message
