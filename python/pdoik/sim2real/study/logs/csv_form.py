"""How a CSV file is written: its columns' names, its separator, its decimal point."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.csv

from pdoik.errors import LoadError


@dataclass(frozen=True, slots=True, kw_only=True)
class CsvForm:
    """Told by the first two lines."""

    header: tuple[str, ...]
    separator: str
    decimal: str

    @classmethod
    def of_lines(cls, name: str, head: str, second: str) -> CsvForm:
        """The form of a file that begins with these lines.

        Args:
            name: what messages call the file.
            head: its first line.
            second: the line after it, "" where there is none.

        Raises:
            LoadError: the first line is no header.
        """
        if not head.strip():
            raise LoadError(f"{name}: empty; expected a header line 'time,q.<joint>,...'")
        counts = {each: head.count(each) for each in ",;\t"}
        separator = max(counts, key=lambda each: counts[each])
        comma = separator != "," and "," in second and "." not in second
        header = tuple(each.strip() for each in next(csv.reader([head], delimiter=separator)))
        if all(is_number(each) for each in header):
            raise LoadError(f"{name}: the first line holds numbers, expected the columns' names")
        twice = sorted({each for each in header if header.count(each) > 1})
        if twice:
            raise LoadError(f"{name}: column {twice[0]!r} is there more than once")
        return cls(header=header, separator=separator, decimal="," if comma else ".")

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
                column_types=dict.fromkeys(columns, pa.float64()),
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
