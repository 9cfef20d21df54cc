"""How a CSV file is written: its columns' names, its separator, its decimal point."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.csv

from pdoik.errors import LoadError

LOOKED_AT = 60
"""Lines at the beginning among which the names are looked for."""

_MISSING = ("", "na", "n/a", "null", "none")
_MOMENT = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d")  # ISO 8601
_TIME_OF_DAY = re.compile(r"\d\d:\d\d:\d\d(\.\d+)?")
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")
_UNIT = re.compile(r"[\[(]?[A-Za-z°µ%1-]{0,10}([./*·^ ][A-Za-z0-9^-]{1,6})*[\])]?")


@dataclass(frozen=True, slots=True, kw_only=True)
class CsvForm:
    """The form of a CSV file, known by its first lines."""

    header: tuple[str, ...]
    separator: str  # a space stands for any number of them
    decimal: str
    units: tuple[str, ...]  # of each column, as a line below the names says them
    moments: dict[str, pa.DataType]  # columns of dates, or of the time of day
    first: int  # line of the first row, from 0

    @classmethod
    def of_lines(cls, name: str, lines: Sequence[str]) -> CsvForm:
        """The form of a file that begins with these lines.

        Names stand in the line above the first row of numbers that has as many cells, whatever is
        said before; between them may be a line of units, or more of the names.

        Args:
            name: what messages call the file.
            lines: its first ones.

        Raises:
            LoadError: no line is a header.
        """
        if not any(each.strip() for each in lines):
            raise LoadError(f"{name}: empty; expected a header line 'time,q.<joint>,...'")
        at, between, first = _beginning(lines)
        separator = _separator(lines[at])
        header = _names(lines[at], separator)
        if all(is_number(each) for each in header):
            raise LoadError(f"{name}: the first line holds numbers, expected the columns' names")
        below = _cells(lines[between], separator) if between else [""] * len(header)
        units = below
        if between and (len(set(header)) < len(header) or not all(map(_is_unit, below))):
            header = [f"{a}.{b}".strip(".") for a, b in zip(header, below, strict=True)]
            units = [""] * len(header)
        twice = sorted({each for each in header if header.count(each) > 1})
        if twice:
            raise LoadError(f"{name}: column {twice[0]!r} is there more than once")
        row = lines[first] if first < len(lines) else ""
        kinds = zip(header, map(_moment, _cells(row, separator)), strict=False)
        return cls(
            header=tuple(header),
            separator=separator,
            decimal="," if separator != "," and "," in row and "." not in row else ".",
            units=tuple(units),
            moments={column: kind for column, kind in kinds if kind is not None},
            first=first,
        )

    def options(
        self, columns: list[str], on_ragged: Callable[[Any], str], *, skip: int, block: int
    ) -> dict[str, Any]:
        """Arrow's options to read columns as numbers.

        Args:
            columns: that are wanted.
            on_ragged: called with each row that has another number of cells.
            skip: rows at the beginning that hold none.
            block: bytes read at a time.
        """
        return {
            "read_options": pa.csv.ReadOptions(
                column_names=list(self.header), skip_rows=skip, block_size=block, use_threads=False
            ),
            "parse_options": pa.csv.ParseOptions(
                delimiter=self.separator, invalid_row_handler=on_ragged
            ),
            "convert_options": pa.csv.ConvertOptions(
                include_columns=columns,
                column_types={each: self.moments.get(each, pa.float64()) for each in columns},
                decimal_point=self.decimal,
            ),
        }


def is_number(text: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def _beginning(lines: Sequence[str]) -> tuple[int, int, int]:
    """The line of the names, that between them and the numbers or 0, and the first row."""
    written = [k for k, line in enumerate(lines) if line.strip()]
    for position, at in enumerate(written):
        separator = _separator(lines[at])
        names = _names(lines[at], separator)
        numbers = [each for each in names if is_number(each)]
        if len(names) < 2 or len(numbers) == len(names) or (position and numbers):
            continue
        below = [(k, _cells(lines[k], separator)) for k in written[position + 1 : position + 3]]
        alike = [len(cells) == len(names) for _, cells in below]
        if alike[:1] == [True] and _is_row(below[0][1]):
            return at, 0, below[0][0]
        if alike == [True, True] and _is_row(below[1][1]) and not any(map(is_number, below[0][1])):
            return at, below[0][0], below[1][0]
    return written[0], 0, written[0] + 1


def _separator(head: str) -> str:
    counts = {each: head.count(each) for each in ",;\t"}
    separator = max(counts, key=lambda each: counts[each])
    return separator if counts[separator] or " " not in head.strip(" #%\r\n") else " "


def _names(line: str, separator: str) -> list[str]:
    """Cells of a line that may be marked as a remark."""
    return _cells(line.lstrip("#% "), separator)


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    rows = csv.reader([line.strip("\r\n")], delimiter=separator)
    return [each.strip() for each in next(rows, [])]


def _is_row(cells: Sequence[str]) -> bool:
    """Whether most of what is there are numbers."""
    values = [each for each in cells if each.lower() not in _MISSING]
    numbers = [each for each in values if is_number(each.replace(",", ".")) or _moment(each)]
    return not values or 2 * len(numbers) > len(values)


def _is_unit(cell: str) -> bool:
    return _UNIT.fullmatch(cell) is not None


def _moment(cell: str) -> pa.DataType | None:
    if _TIME_OF_DAY.fullmatch(cell):
        return pa.time64("ns")
    if not _MOMENT.match(cell):
        return None
    return pa.timestamp("ns", tz="UTC" if _ZONE.search(cell) else None)
