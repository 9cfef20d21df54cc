"""pdoik thresholds: every number that decides what a diagnosis says."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from pdoik._extras import asks_for

from .messages import out
from .tables import json_text

if TYPE_CHECKING:
    from pdoik.sim2real import Thresholds


def thresholds(
    json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """The numbers that decide what `pdoik diagnose` believes: value, unit, meaning, source.

    [bold]Example[/]: pdoik thresholds
    """
    with asks_for("sim2real"):
        from pdoik.sim2real import Thresholds
    if json:
        listed = [asdict(each) for each in Thresholds()]
        out.print(json_text({"thresholds": listed}), highlight=False, markup=False)
        return
    out.print(_table(Thresholds()))


def _table(known: Thresholds) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("threshold", "value", "unit", "meaning", "source"):
        table.add_column(name, no_wrap=name in ("threshold", "value", "unit"))
    for each in known:
        cells = (each.name, f"{each.value:g}", each.unit, each.meaning, each.source)
        table.add_row(*map(escape, cells))
    return table
