"""The outcome of pdoik solve --all for people: a row for each solution."""

from __future__ import annotations

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from .messages import out
from .solution import AllSolutions, distance_to
from .tables import length_text, time_text


def print_all(solution: AllSolutions) -> None:
    """How many there are, whether these are all, and each, the nearest first."""
    found, count = solution.answer, len(solution.answer)
    if not count:
        out.print(f"[bold red]no solution: {escape(found.status.replace('_', ' '))}[/]")
    else:
        out.print(f"[bold green]{count} solution{'s' * (count > 1)}[/], {_how_sure(solution)}")
        start = "the middle of the ranges" if solution.question.q0 is None else "--q0"
        out.print(f"distances are from {start}", style="dim", highlight=False)
        out.print(_table(solution))
    out.print(f"{found.restarts} restarts, {time_text(found.time)}", highlight=False)


def _how_sure(solution: AllSolutions) -> str:
    """Whether there may be others."""
    found, limit = solution.answer, solution.question.limit
    if limit is not None and len(found) == limit:
        return "as many as --limit lets be"
    if found.complete:
        return "all there are"
    return (
        f"coverage {found.coverage:.0%}: as likely one more start ends in one of those that were"
        " come upon"
    )


def _table(solution: AllSolutions) -> Table:
    robot, found = solution.robot, solution.answer
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    kinds = set(robot.joint_types)
    for name in ("", "distance", "clearance", "turns"):
        table.add_column(name, justify="right")
    table.add_column(f"joints {'rad or m' if 'prismatic' in kinds else 'rad'}")
    for k, (result, turns) in enumerate(zip(found, found.turns, strict=True)):
        table.add_row(
            str(k + 1),
            f"{distance_to(solution, result):.4f}",
            length_text(result.clearance),
            str(turns),
            " ".join(f"{q:+.4f}" for q in np.asarray(result.q)),
        )
    return table
