"""Puts a report's tables into a README, between its markers, with where they were measured.

    python -m bench.common.publish build/bench/tracking/tables.md bench/ik/tracking/README.md

A README says where a table goes:

    <!-- bench.ik.tracking: Summary -->
    <!-- end -->

That is the table which this command writes below a heading (## or bold) with these words; without
a heading it is the first. What is between such markers is written again, and nothing else.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from bench.common.commands import console, plain_errors
from bench.common.whole_files import write_text

_BLOCK = re.compile(
    r"<!-- (?P<mark>(?P<of>bench[.\w]+)(?:: (?P<title>.*?))?) -->\n.*?<!-- end -->", re.DOTALL
)
_HEADING = re.compile(r"^(?:#+ (?P<heading>.*)|\*\*(?P<bold>[^*]*)\*\*.*)$")
_NEEDED = ("command", "commit", "processor", "load before")
_SHOWN = ("command", "commit", "date", "processor", "processors", "load before", "kernels")


class PublishError(RuntimeError):
    """The report has no such table, or does not say where it was measured."""


def published(report: str, readme: str) -> tuple[str, int]:
    """The README with the report's tables, and how many it took.

    Raises:
        PublishError: A marker names a table that the report has not, or facts are missing.
    """
    tables, facts = tables_of(report), facts_of(report)
    line = f"*{'; '.join(f'{name}: {facts[name]}' for name in _SHOWN if name in facts)}*"
    count = 0

    def block(match: re.Match[str]) -> str:
        nonlocal count
        if match["of"] not in facts["command"].split():
            return match[0]
        title = (match["title"] or "").lower()
        found = [table for name, table in tables if title in name.lower()]
        if not found:
            raise PublishError(f"no table {title!r}; there are {[name for name, _ in tables]}")
        count += 1
        return f"<!-- {match['mark']} -->\n{line}\n\n{found[0]}\n<!-- end -->"

    return _BLOCK.sub(block, readme), count


def tables_of(report: str) -> list[tuple[str, str]]:
    """Headings and the tables below them, in their order; a table's own paragraphs apart."""
    title, rows, tables = "", list[str](), list[tuple[str, str]]()
    for line in [*report.splitlines(), ""]:
        if line.startswith("|"):
            rows.append(line)
            continue
        if rows:
            tables.append((title, "\n".join(rows)))
            rows = []
        if match := _HEADING.match(line):
            title = match["heading"] or match["bold"]
    return tables


def facts_of(report: str) -> dict[str, str]:
    """What the report begins with.

    Raises:
        PublishError: It does not say by which command, at which commit, or on what.
    """
    facts = dict(re.findall(r"^- ([^:\n]+): (.*)$", report, re.MULTILINE))
    if missing := [name for name in _NEEDED if name not in facts]:
        raise PublishError(f"the report does not say: {', '.join(missing)}")
    return facts


def main(
    report: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="A tables.md.")],
    readme: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="With markers.")],
) -> None:
    """Put a report's tables into a README."""
    with plain_errors():
        text, count = published(report.read_text(), readme.read_text())
        if not count:
            raise PublishError(f"{readme} has no marker of that command")
        write_text(readme, text)
    console.print(f"{count} tables: {readme}", highlight=False)


if __name__ == "__main__":
    typer.run(main)
