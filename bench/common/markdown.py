"""Tables as text."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


def markdown_table(header: Sequence[object], rows: Sequence[Sequence[object]]) -> str:
    """Names to the left, numbers to the right."""
    texts = [[str(cell) for cell in row] for row in rows]
    numeric = [
        bool(texts) and all(row[k][:1] in "0123456789-+." for row in texts if row[k])
        for k in range(len(header))
    ]
    rule = ["---:" if number else "---" for number in numeric]
    lines = [[str(name) for name in header], rule, *texts]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"


def table_of(
    name: str | Sequence[str],
    groups: Iterable[tuple[Any, pd.DataFrame]],
    columns: Mapping[str, Callable[[pd.DataFrame], object]],
) -> str:
    """A row for each group, with what its columns make of it.

    Args:
        name: heading of the groups' keys, or headings where keys are tuples.
        groups: as pandas' groupby has them.
        columns: by heading.
    """
    header = [name] if isinstance(name, str) else [*name]
    rows = [
        [*(key if isinstance(key, tuple) else (key,)), *(cell(part) for cell in columns.values())]
        for key, part in groups
    ]
    return markdown_table([*header, *columns], rows)
