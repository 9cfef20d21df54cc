"""Tables as text."""

from __future__ import annotations

from collections.abc import Sequence


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
