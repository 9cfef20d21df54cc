"""Which rows of a log to keep, and how many are too many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.errors import LoadError

MAX_ROWS = 1_000_000
"""Rows kept of one log unless more is asked for: more than an hour at 250 Hz."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Which rows of a log to keep."""

    every: int = 1  # each n-th row
    window: tuple[float, float] | None = None  # [s] since the log's first row
    max_rows: int = MAX_ROWS

    @property
    def notes(self) -> tuple[str, ...]:
        """What is left out, in words."""
        notes = []
        if self.every > 1:
            notes.append(f"only every {self.every}th row was read, as was asked")
        if self.window is not None:
            first, last = self.window
            notes.append(f"only {first:g} s to {last:g} s were read, as was asked")
        return tuple(notes)


def check_size(name: str, rows: float, part: Part) -> None:
    """Ask for a smaller part.

    Raises:
        LoadError: the whole of a log is wanted and has too many rows.
    """
    if part.window is None and rows / part.every > part.max_rows:
        thin = int(np.ceil(rows / part.max_rows))
        raise LoadError(
            f"{name}: about {rows:,.0f} rows, expected at most {part.max_rows:,};"
            f" take a piece of it with 'window: [0, 600]' [s], or every"
            f" {thin}th row with 'every: {thin}', or allow more with 'max_rows:'"
        )
