"""Markdown tables of trials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pdoik.h1.experiment import Job
from pdoik.h1.store import Record


def table(head: Sequence[str], rows: Iterable[Sequence[str]], n_text: int = 1) -> str:
    """Markdown; the first n_text columns are words, the others numbers."""
    rule = ["---" if k < n_text else "---:" for k in range(len(head))]
    lines = [head, rule, *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def mm(metres: float | None, digits: int = 0) -> str:
    """A length in millimetres."""
    return "-" if metres is None else f"{1e3 * metres:.{digits}f}"


def of_setup(records: dict[Job, Record], setup: str) -> dict[Job, Record]:
    """The trials of one set-up."""
    return {job: record for job, record in records.items() if job.setup.name == setup}


def setups(records: dict[Job, Record]) -> list[str]:
    """Those that the trials are of, in order."""
    return list(dict.fromkeys(job.setup.name for job in records))
