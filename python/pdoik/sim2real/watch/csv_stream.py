"""Lines of a CSV as they are written, in columns; a half-written last line waits for its rest."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.csv

from pdoik._nearest import nearest
from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Reading
from pdoik.recordings.logs import Column, CsvForm, is_number, numbers
from pdoik.recordings.names import Known, listed, settle

_TORN = 0.1  # share of a piece's lines that may hold no numbers, as where a file was cut off
_LONGEST = 1 << 20  # numerics: bytes of a line


class CsvStream:
    """One log's columns for a model's joints."""

    def __init__(self, name: str, joints: Sequence[str], reading: Reading | None = None) -> None:
        """Stream of a log of this name, which is read as a study says."""
        self.name = name
        self._reading = reading or Reading()
        self.torn = 0  # lines that were left out
        self._joints = tuple(joints)
        names = (f"{channel}.{joint}" for channel in ("q", "tau") for joint in joints)
        self._columns = ["time", *names]
        self._rest = b""
        self._form: CsvForm | None = None
        self._sources: list[str] = []  # what the log calls the columns
        self._factors = np.empty(0)  # to SI

    def begin(self) -> None:
        """The next line is the first of another file; one without a header has that of before."""
        self._rest = b""
        self._first = True

    _first = True

    def add(self, piece: bytes) -> Iterator[dict[str, FloatArray]]:
        """Columns of the lines that are whole with this piece.

        Raises:
            LoadError: the header lacks a column, or lines hold no numbers.
        """
        whole, newline, rest = (self._rest + piece).rpartition(b"\n")
        if not newline:
            self._rest = rest
            if len(rest) > _LONGEST:
                raise LoadError(f"{self.name}: no line ends within {_LONGEST} bytes, expected CSV")
            return
        lines = whole + newline
        if self._first:
            head, _, after = lines.partition(b"\n")
            second, newline, _ = after.partition(b"\n")
            if not newline and not self._is_row(head):  # the next line shows the decimal point
                self._rest = self._rest + piece
                return
            lines = self._begun(head, second, lines, after)
        self._rest = rest
        if lines.strip():
            yield self._numbers(lines)

    def _begun(self, head: bytes, second: bytes, lines: bytes, after: bytes) -> bytes:
        self._first = False
        if self._form is not None and self._is_row(head):
            return lines
        form = CsvForm.of_lines(self.name, [_text(self.name, each) for each in (head, second)])
        given = tuple(Column(name=each) for each in form.header)
        said = self._reading
        known = Known(joints=self._joints, key=said.key, ignore=said.ignore)
        settled, _ = settle(self.name, given, known)
        found = {each.target: each for each in settled}
        for column in self._columns:
            if column not in found:
                raise LoadError(
                    f"{self.name}: expected a column {column!r}{nearest(column, form.header)}; it"
                    f" has {listed(form.header)}"
                )
        units = said.said_units.with_written(
            {each.target: each.unit for each in settled if each.unit}
        )
        self._sources = [found[each].column.name for each in self._columns]
        self._factors = np.array(
            [found[each].factor * units.factor(each) for each in self._columns]
        )
        self._form = form
        return after

    def _is_row(self, line: bytes) -> bool:
        form = self._form
        if form is None:
            return False
        cells = _text(self.name, line).strip().split(form.separator)
        return len(cells) == len(form.header) and all(
            not each or is_number(each.replace(form.decimal, ".")) for each in cells
        )

    def _numbers(self, lines: bytes) -> dict[str, FloatArray]:
        try:
            rows = self._parsed(lines)
        except pa.ArrowInvalid:
            rows = self._line_by_line(lines)
        return {each: rows[:, k] for k, each in enumerate(self._columns)}

    def _parsed(self, lines: bytes) -> FloatArray:
        def skip(_row: object) -> str:
            self.torn += 1
            return "skip"

        assert self._form is not None
        options = self._form.options(self._sources, skip, skip=0, block=max(len(lines), 1024))
        table = pa.csv.read_csv(io.BytesIO(lines), **options)
        batches = [numbers(batch, self._sources) for batch in table.to_batches()]
        return np.concatenate([np.empty((0, len(self._columns))), *batches]) * self._factors

    def _line_by_line(self, lines: bytes) -> FloatArray:
        """Rows of numbers, without the lines that hold something else than numbers."""
        kept, lost, reason = [], 0, ""
        every = lines.splitlines(keepends=True)
        for line in every:
            try:
                kept.append(self._parsed(line))
            except pa.ArrowInvalid as error:
                lost, reason = lost + 1, reason or str(error)
        if lost > max(1.0, _TORN * len(every)):
            raise LoadError(
                f"{self.name}: {lost} of {len(every)} lines hold something else than numbers:"
                f" {reason}"
            )
        self.torn += lost
        return np.concatenate([np.empty((0, len(self._columns))), *kept])


def _text(name: str, line: bytes) -> str:
    try:
        return line.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LoadError(f"{name}: no CSV text: {error}") from None
