"""CSV files, read in pieces: a log may be larger than the memory."""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO, TextIO, cast

import pyarrow as pa
import pyarrow.csv

from pdoik.errors import LoadError

from ..recording import FloatArray
from .arrow_numbers import numbers
from .csv_form import LOOKED_AT, CsvForm
from .kinds import KINDS, register
from .log import Column, Log

_BLOCK = 8 << 20  # bytes parsed at a time
_UTF8, _WINDOWS = "utf-8-sig", "cp1252"
_RAGGED = 0.01  # share of rows with another number of cells that is still a log


@register
class CsvText(Log):
    """A line of names, then a line of numbers for each row; remarks and units may stand before."""

    kind = "CSV"
    suffixes = (".csv", ".tsv", ".txt", ".csv.gz", ".tsv.gz", ".txt.gz")

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        self.notes = []
        self._path, self._name = path, name
        try:
            self._encoding = _encoding(self._file)
            with self._text() as file:
                lines = list(islice(file, LOOKED_AT))
            self.rows = self._count()
        except (OSError, UnicodeDecodeError, EOFError) as error:
            kinds = ", ".join(KINDS)
            raise LoadError(f"{name}: no CSV text, and none of {kinds}: {error}") from error
        self._form = form = CsvForm.of_lines(name, lines)
        self.columns = tuple(
            Column(name=each, unit="s", converted=True)
            if each in form.moments
            else Column(name=each, unit=unit)
            for each, unit in zip(form.header, form.units, strict=True)
        )

    def _file(self) -> BinaryIO:
        opened = gzip.open if self._path.suffix == ".gz" else open
        return cast(BinaryIO, opened(self._path, "rb"))

    def _text(self) -> TextIO:
        errors = "strict" if self._encoding == _UTF8 else "replace"
        return io.TextIOWrapper(self._file(), encoding=self._encoding, errors=errors)

    def _stream(self) -> Any:
        """Bytes as Arrow takes them: UTF-8, and one separator between two cells."""
        spaced = self._form.separator == " "
        if not spaced and self._encoding == _UTF8:
            return pa.input_stream(str(self._path), compression="detect")

        def change(line: bytes) -> bytes:
            text = line.decode(self._encoding, errors="replace")
            return (" ".join(text.split()) + "\n" if spaced else text).encode()

        return pa.PythonFile(_Changed(self._file(), change), mode="r")

    def _count(self) -> float:
        """About how many rows the file has, from its size and the first lines."""
        size = self._path.stat().st_size * (1 if self._path.suffix != ".gz" else 3)
        with self._text() as file:
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
            with (
                self._stream() as stream,
                pa.csv.open_csv(
                    stream,
                    **self._form.options(list(columns), skip, skip=self._form.first, block=_BLOCK),
                ) as reader,
            ):
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


def _encoding(opened: Callable[[], BinaryIO]) -> str:
    """The encoding of a file's first lines: UTF-8, else that of Windows."""
    with opened() as file:
        begin = b"".join(islice(file, LOOKED_AT))
    try:
        begin.decode("utf-8")
    except UnicodeDecodeError:
        if b"\0" in begin:
            raise
        return _WINDOWS
    return _UTF8


class _Changed:
    """A file whose lines are changed as they are read."""

    def __init__(self, file: BinaryIO, change: Callable[[bytes], bytes]) -> None:
        self._file, self._change = file, change
        self._ready = b""
        self.closed = False

    def read(self, size: int = _BLOCK) -> bytes:
        """At most `size` bytes of the file."""
        if not self._ready:
            self._ready = b"".join(map(self._change, self._file.readlines(size)))
        found, self._ready = self._ready[:size], self._ready[size:]
        return found

    def close(self) -> None:
        """The file, too."""
        self._file.close()
        self.closed = True


def _worded(message: str, columns: Sequence[str]) -> str:
    """Arrow's message with the column's name for its number."""
    head, colon, rest = message.partition(": ")
    number = head.removeprefix("In CSV column #")
    if colon and number.isdigit() and int(number) < len(columns):
        return f"column {columns[int(number)]!r}: {rest}"
    return message
