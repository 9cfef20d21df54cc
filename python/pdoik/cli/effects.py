"""pdoik effects: the physics that a diagnosis knows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from .messages import fail, out
from .sim2real_extra import extra_needed

if TYPE_CHECKING:
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
    with extra_needed("effects"):
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
    with extra_needed("effects"):
        from pdoik.sim2real.effects import CATALOGUE
        from pdoik.sim2real.study.columns import nearest
    if effect not in CATALOGUE:
        fail(f"no effect {effect!r}{nearest(effect, CATALOGUE)}")
    for line in _facts(CATALOGUE[effect]):
        out.print(escape(line), highlight=False)


def _facts(effect: Effect) -> list[str]:
    lines = [f"{effect.id}: {effect.words}", "", f"    {effect.equation}", ""]
    lines += [f"{p.name} [{p.unit}], {p.lower:g} to {p.upper:g}" for p in effect.parameters]
    said = {
        "family": effect.family,
        "on": effect.on,
        "acts in a part of time or positions": "maybe" if effect.gated else "no",
        "confused with": ", ".join(effect.confused_with),
        "decided by": effect.decided_by,
        "only beside": ", ".join(effect.beside),
        "source": effect.source,
    }
    return [*lines, "", *(f"{name}: {value}" for name, value in said.items() if value)]
