"""CSV and Parquet files as raw columns, read in pieces: a log may be larger than the memory."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO, cast

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from pdoik.errors import LoadError

from .columns import Table, nearest
from .csv_form import CsvForm
from .recording import FloatArray

MAX_ROWS = 1_000_000
"""Rows kept of one file unless the study says otherwise: more than an hour at 250 Hz."""

_BLOCK = 8 << 20  # bytes of CSV parsed at a time
_RAGGED = 0.01  # share of rows with another number of cells that is still a log


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Which rows of a file to keep."""

    every: int = 1  # each n-th row
    window: tuple[float, float] | None = None  # [s] since the file's first row
    max_rows: int = MAX_ROWS


def read_table(
    path: Path, name: str, wanted: Callable[[str], bool], part: Part, time_unit: float = 1.0
) -> Table:
    """The columns of a CSV or Parquet file whose names are wanted.

    Args:
        path: .csv, .tsv, .txt, each also .gz, .parquet or .pq.
        name: What messages call the file.
        wanted: Says whether a column is needed; `time` always is.
        part: Which rows.
        time_unit: Of the column `time` [s].

    Raises:
        LoadError: it cannot be read, has no `time`, a cell is no number, or it has too many rows.
    """
    if not path.is_file():
        beside = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"{name}: no such file: {path}{nearest(path.name, beside)}")
    file: _Csv | _Parquet
    file = _Parquet(path, name) if path.suffix in (".parquet", ".pq") else _Csv(path, name)
    if "time" not in file.header:
        raise LoadError(
            f"{name}: expected a column 'time' [s]{nearest('time', file.header)}; it has"
            f" {_listed(file.header)}"
        )
    columns = [each for each in file.header if each == "time" or wanted(each)]
    _check_size(name, file.rows(), part)
    start, rows = _gather(name, file.pieces(columns), columns, part, time_unit)
    if not len(rows):
        raise LoadError(f"{name}: no rows" + ("" if part.window is None else " in the window"))
    others = tuple(each for each in file.header if each not in columns)
    values = {each: rows[:, k] for k, each in enumerate(columns) if each != "time"}
    time = rows[:, columns.index("time")]
    notes = (*file.notes, *_part_notes(part))
    return Table(name=name, start=start, time=time, columns=values, others=others, notes=notes)


def _gather(
    name: str, pieces: Iterator[FloatArray], columns: list[str], part: Part, time_unit: float
) -> tuple[float, FloatArray]:
    """Time of the first row [s] and the rows kept, their time since then."""
    at = columns.index("time")
    start = None
    kept: list[FloatArray] = []
    seen = count = 0
    for piece in pieces:
        if start is None and np.isfinite(piece[:, at]).any():
            start = float(piece[np.isfinite(piece[:, at]), at][0])
        piece[:, at] = (piece[:, at] - (start or 0.0)) * time_unit
        rows = piece[(-seen) % part.every :: part.every]
        seen += len(piece)
        if part.window is not None:
            inside = (rows[:, at] >= part.window[0]) & (rows[:, at] <= part.window[1])
            rows = rows[inside]
        kept.append(rows)
        count += len(rows)
        _check_size(name, count, Part(max_rows=part.max_rows))
        if part.window is not None and len(piece) and piece[-1, at] > part.window[1]:
            break
    if not kept:
        return 0.0, np.empty((0, len(columns)))
    table = np.concatenate(kept)
    first = float(table[0, at]) if len(table) and np.isfinite(table[0, at]) else 0.0
    table[:, at] -= first
    return (start or 0.0) * time_unit + first, table


def _check_size(name: str, rows: float, part: Part) -> None:
    if part.window is None and rows / part.every > part.max_rows:
        thin = int(np.ceil(rows / part.max_rows))
        raise LoadError(
            f"{name}: about {rows:,.0f} rows, expected at most {part.max_rows:,}; in the study,"
            f" take a piece of it with '{{file: {name}, window: [0, 600]}}' [s], or every"
            f" {thin}th row with 'every: {thin}', or allow more with 'max_rows:'"
        )


def _part_notes(part: Part) -> tuple[str, ...]:
    notes = []
    if part.every > 1:
        notes.append(f"only every {part.every}th row was read, as the study says")
    if part.window is not None:
        first, last = part.window
        notes.append(f"only {first:g} s to {last:g} s were read, as the study says")
    return tuple(notes)


def _listed(names: list[str]) -> str:
    return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")


class _Csv:
    """A CSV file's header, size and rows."""

    def __init__(self, path: Path, name: str) -> None:
        self.notes: list[str] = []
        self._path, self._name = path, name
        try:
            with self._open() as file:
                head = file.readline()
                second = file.readline()
        except (OSError, UnicodeDecodeError, EOFError) as error:
            raise LoadError(f"{name}: no CSV text: {error}") from error
        self._form = CsvForm.of_lines(name, head, second)
        self.header = list(self._form.header)

    def _open(self) -> TextIO:
        if self._path.suffix == ".gz":
            return cast(TextIO, gzip.open(self._path, "rt", encoding="utf-8-sig"))
        return self._path.open(encoding="utf-8-sig")

    def rows(self) -> float:
        """About how many rows the file has, from its size and the first lines."""
        size = self._path.stat().st_size * (1 if self._path.suffix != ".gz" else 3)
        with self._open() as file:
            lines = [len(line) for _, line in zip(range(1001), file, strict=False)][1:]
        return size * len(lines) / sum(lines) if lines else 0.0

    def pieces(self, columns: list[str]) -> Iterator[FloatArray]:
        ragged = 0

        def skip(_row: Any) -> str:
            nonlocal ragged
            ragged += 1
            return "skip"

        total = 0
        try:
            with pa.csv.open_csv(
                pa.input_stream(str(self._path), compression="detect"),
                **self._form.options(columns, skip, skip=1, block=_BLOCK),
            ) as reader:
                for batch in reader:
                    total += batch.num_rows
                    yield numbers_of(batch, columns)
        except (pa.ArrowInvalid, OSError) as error:
            raise LoadError(f"{self._name}: {_worded(str(error), columns)}") from error
        if ragged > max(1, _RAGGED * total):
            raise LoadError(
                f"{self._name}: {ragged} of {ragged + total} rows have another number of cells than"
                f" the header ({len(self.header)})"
            )
        if ragged:
            self.notes.append(f"{ragged} incomplete row(s) left out")


class _Parquet:
    """A Parquet file's header, size and rows."""

    def __init__(self, path: Path, name: str) -> None:
        self.notes: list[str] = []
        self._name = name
        try:
            self._file = pa.parquet.ParquetFile(path)
        except (pa.ArrowInvalid, OSError) as error:
            raise LoadError(f"{name}: no Parquet file: {error}") from error
        self.header: list[str] = list(self._file.schema_arrow.names)

    def rows(self) -> float:
        return float(self._file.metadata.num_rows)

    def pieces(self, columns: list[str]) -> Iterator[FloatArray]:
        for batch in self._file.iter_batches(columns=columns):
            yield numbers_of(batch, columns, self._name)


def numbers_of(batch: Any, columns: list[str], name: str = "") -> FloatArray:
    """A batch's columns, (T, c); infinite values become NaN."""
    out = np.empty((batch.num_rows, len(columns)))
    for k, column in enumerate(columns):
        values = batch.column(column)
        if pa.types.is_timestamp(values.type):
            values = values.cast(pa.timestamp("ns")).cast(pa.int64())
            out[:, k] = values.to_numpy(zero_copy_only=False) * 1e-9
            continue
        try:
            cells = values.cast(pa.float64()).to_numpy(zero_copy_only=False)
        except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
            raise LoadError(
                f"{name}: column {column!r} holds {values.type}, expected numbers"
            ) from error
        out[:, k] = cells
    out[~np.isfinite(out)] = np.nan
    return out


def _worded(message: str, columns: list[str]) -> str:
    """Arrow's message with the column's name for its number."""
    head, colon, rest = message.partition(": ")
    number = head.removeprefix("In CSV column #")
    if colon and number.isdigit() and int(number) < len(columns):
        return f"column {columns[int(number)]!r}: {rest}"
    return message
