"""pdoik effects: the physics that a diagnosis knows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from pdoik._extras import asks_for

from .messages import NOT_SOLVED, fail, misuse_fails, out

if TYPE_CHECKING:
    from pdoik.sim2real.effect_check import Outcome
    from pdoik.sim2real.effects import Effect

app = typer.Typer(name="effects", no_args_is_help=True, rich_markup_mode="rich")


@app.callback()
def effects() -> None:
    """The physics that `pdoik diagnose` looks for, entry points of the group pdoik.effects too."""


@app.command("list")
def list_effects() -> None:
    """Every effect: its family, where it sits, its equation.

    [bold]Example[/]: pdoik effects list
    """
    with asks_for("sim2real"):
        from pdoik.sim2real.effects import CATALOGUE
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("effect", "family", "on", "equation"):
        table.add_column(name, no_wrap=name != "equation")
    for effect in sorted(CATALOGUE.values(), key=lambda each: each.family):
        table.add_row(*map(escape, (effect.id, effect.family, effect.on, effect.equation)))
    out.print(table)


@app.command("show")
def show(effect: Annotated[str, typer.Argument(help="Its id, as `list` has it.")]) -> None:
    """One effect: equation, parameters with their units and bounds, what it is confused with.

    [bold]Example[/]: pdoik effects show backlash
    """
    with asks_for("sim2real"):
        from pdoik._nearest import nearest
        from pdoik.sim2real.effects import CATALOGUE
    if effect not in CATALOGUE:
        fail(f"no effect {effect!r}{nearest(effect, CATALOGUE)}")
    for line in _facts(CATALOGUE[effect]):
        out.print(escape(line), highlight=False)


@app.command("check")
def check(
    effect: Annotated[str, typer.Argument(help="A Python file with effects, or an id.")],
    diagnose: Annotated[
        bool, typer.Option("--diagnose", help="Also simulate recordings and diagnose them.")
    ] = False,
) -> None:
    """Is an effect what it says of itself? Ends with status 1 where a check fails.

    Its columns are held against its own simulation, its figures against its bounds, and so on.

    [bold]Example[/]: pdoik effects check my_effect.py
    """
    with asks_for("sim2real"):
        from pdoik.sim2real.effect_check import check_effect, load_effects
    with misuse_fails():
        effects = load_effects(effect)
    good = True
    for each in effects:
        outcomes = check_effect(each, diagnose=diagnose)
        good = good and all(outcome.status != "fail" for outcome in outcomes)
        for line in _lines(each.id, outcomes):
            out.print(line, highlight=False)
    if not good:
        raise typer.Exit(NOT_SOLVED)


_COLOUR = {"pass": "green", "fail": "bold red", "not applicable": "dim"}


def _lines(title: str, outcomes: Iterable[Outcome]) -> Iterator[str]:
    """A table whose last column may be as long as it likes."""
    yield f"[bold]{escape(title)}[/]"
    yield f"  {'check':<28}{'result':<16}{'measured':>9}{'limit':>8}"
    for each in outcomes:
        figures = ["" if math.isnan(f) else f"{f:.3g}" for f in (each.measured, each.limit)]
        result = f"[{_COLOUR[each.status]}]{each.status:<16}[/]"
        yield f"  {each.check:<28}{result}{figures[0]:>9}{figures[1]:>8}  {escape(each.words)}"


def _facts(effect: Effect) -> list[str]:
    lines = [f"{effect.id}: {effect.words}", "", f"    {effect.equation}", ""]
    lines += [f"{p.name} [{p.unit}], {p.lower:g} to {p.upper:g}" for p in effect.parameters]
    said = {
        "family": effect.family,
        "on": effect.on,
        "acts in a part of time or positions": "maybe" if effect.gated else "no",
        "confused with": ", ".join(effect.confused_with),
        "decided by": effect.decided_by,
        "source": effect.source,
    }
    return [*lines, "", *(f"{name}: {value}" for name, value in said.items() if value)]
