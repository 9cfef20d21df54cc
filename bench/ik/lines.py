"""The table: what is asked, what was measured, of how many cases, and how many of them fail."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from bench.common.markdown import markdown_table

Jobs = dict[str, dict[str, Any]]


def jobs_of(size: int, seed: int, **axes: Iterable[str]) -> Jobs:
    """So many indices of all that the axes name; the last axis changes fastest."""
    return {
        "-".join([f"{index:03d}", *(word.replace(" ", "_") for word in words)]): {
            "index": index,
            "seed": seed,
            **dict(zip(axes, words, strict=True)),
        }
        for index in range(size)
        for words in product(*axes.values())
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A row of the table."""

    what: str
    asked: str
    measured: str
    cases: str
    failures: int | str

    def __str__(self) -> str:
        return f"  {self.what}: {self.measured} ({self.cases}); asked {self.asked}"


def report(lines: Mapping[str, Iterable[Line]], seed: int) -> str:
    """Markdown, by experiment."""
    rows = [
        [name, line.what, line.asked, line.measured, line.cases, line.failures]
        for name, some in lines.items()
        for line in some
    ]
    header = ("row", "what", "asked", "measured", "cases", "failures")
    return f"Seed {seed}.\n\n**Promises**\n\n{markdown_table(header, rows)}"


def millimetres(metres: float) -> str:
    """With as many figures as are worth it."""
    value = 1e3 * metres
    return f"{value:.3f}" if abs(value) < 100 else f"{value:.0f}"


def share(hits: Any, total: int) -> str:
    """As a decimal with three figures."""
    return f"{np.sum(hits) / total:.3f}" if total else "none"
