"""Rows of the tables: how many problems were solved, and how the times are spread."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table


@dataclass(frozen=True, slots=True, kw_only=True)
class Solve:
    """One problem's outcome."""

    claimed: bool  # solved, in the solver's opinion
    confirmed: bool  # solved, in the opinion of a check that knows none of the solvers
    time: float  # [s]
    iterations: int
    restarts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One method on one arm. Times are those of all problems, solved or not [us]."""

    arm: str
    method: str
    total: int
    solved: int  # claimed and confirmed
    false_claims: int  # claimed but not confirmed
    median: float
    p95: float
    p99: float
    max: float
    iterations: float  # mean
    restarts: float  # mean

    @classmethod
    def of(cls, arm: str, method: str, solves: Sequence[Solve]) -> Row:
        """The row of these solves."""
        times = 1e6 * np.array([solve.time for solve in solves])
        median, p95, p99 = np.percentile(times, [50, 95, 99])
        return cls(
            arm=arm,
            method=method,
            total=len(solves),
            solved=sum(solve.claimed and solve.confirmed for solve in solves),
            false_claims=sum(solve.claimed and not solve.confirmed for solve in solves),
            median=float(median),
            p95=float(p95),
            p99=float(p99),
            max=float(times.max()),
            iterations=float(np.mean([solve.iterations for solve in solves])),
            restarts=float(np.mean([solve.restarts for solve in solves])),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """One experiment's table."""

    title: str
    rows: list[Row]
    notes: list[str] = dataclasses.field(default_factory=list)
    extra: dict[str, list[str]] = dataclasses.field(default_factory=dict)  # columns beside the rows

    def table(self) -> Table:
        """For a terminal."""
        table = Table(
            title=self.title,
            title_justify="left",
            caption="\n".join(self.notes),
            caption_justify="left",
        )
        for index, name in enumerate(self._header()):
            table.add_column(name, justify="left" if index < 2 else "right")
        for index, row in enumerate(self.rows):
            last_of_arm = index + 1 == len(self.rows) or self.rows[index + 1].arm != row.arm
            table.add_row(*self._cells(index), end_section=last_of_arm)
        return table

    def to_markdown(self) -> str:
        """For bench/README.md."""
        rule = ["---"] * 2 + ["---:"] * (len(self._header()) - 2)
        lines = [self._header(), rule, *(self._cells(index) for index in range(len(self.rows)))]
        table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
        return f"**{self.title}.** {' '.join(self.notes)}\n\n{table}\n"

    def _header(self) -> list[str]:
        times = ["median", "p95", "p99", "max [us]"]
        return [
            "arm",
            "method",
            "solved",
            *times,
            "iterations",
            "restarts",
            *self.ratios,
            *self.extra,
        ]

    def _cells(self, index: int) -> list[str]:
        row, first = self.rows[index], self._first(self.rows[index])
        false_claims = f" ({row.false_claims} false)" if row.false_claims else ""
        ratios = [f"{row.median / first.median:.2f}", f"{row.p95 / first.p95:.2f}"]
        return [
            row.arm,
            row.method,
            f"{row.solved} / {row.total}{false_claims}",
            *(f"{value:.1f}" for value in (row.median, row.p95, row.p99, row.max)),
            f"{row.iterations:.1f}",
            f"{row.restarts:.2f}",
            *(ratios if self.ratios else []),
            *(column[index] for column in self.extra.values()),
        ]

    @property
    def ratios(self) -> list[str]:
        """The names of the columns of ratios, if an arm has more than one row."""
        several = len({row.method for row in self.rows}) > 1
        return ["median x", "p95 x"] if several else []

    def to_json(self) -> dict[str, Any]:
        """For programs: the rows with their ratios."""
        rows = []
        for index, row in enumerate(self.rows):
            first = self._first(row)
            ratios = {"median_ratio": row.median / first.median, "p95_ratio": row.p95 / first.p95}
            extra = {name: column[index] for name, column in self.extra.items()}
            rows.append({**dataclasses.asdict(row), **ratios, **extra})
        return {"title": self.title, "notes": self.notes, "times": "microseconds", "rows": rows}

    def _first(self, row: Row) -> Row:
        """What the row's ratios are to: the first row of the same arm."""
        return next(other for other in self.rows if other.arm == row.arm)
