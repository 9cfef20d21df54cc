"""What the command line prints where, and how it leaves."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NoReturn

import typer
from rich.console import Console
from rich.markup import escape

from pdoik.errors import GoalWarning, LoadError

out = Console(soft_wrap=True)
err = Console(stderr=True, soft_wrap=True)

NOT_SOLVED = 1
MISUSE = 2


def fail(message: str) -> NoReturn:
    """Print one line that says what is wrong, and leave with status 2."""
    err.print(f"[bold red]error:[/] {escape(' '.join(message.split()))}", highlight=False)
    raise typer.Exit(MISUSE)


def warn(message: str) -> None:
    """Print one line on stderr and go on."""
    err.print(f"[bold yellow]warning:[/] {escape(' '.join(message.split()))}", highlight=False)


def tell(message: str) -> None:
    """Print one line on stderr that a user may want to check."""
    err.print(escape(" ".join(message.split())), highlight=False)


@contextmanager
def misuse_fails(subject: str = "") -> Iterator[None]:
    """Turn what the library says about bad input into one line and status 2.

    Args:
        subject: The option or file to name before the library's words.
    """
    try:
        yield
    except (LoadError, ValueError, OSError) as error:
        reason = str(error)
        if isinstance(error, OSError) and error.strerror:
            reason = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
        fail(f"{subject}: {reason}" if subject else reason)


@contextmanager
def warnings_given(kind: type[Warning] = GoalWarning) -> Iterator[None]:
    """Print what the library warns of as lines of this program."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", kind)
        try:
            yield
        finally:
            for each in said:
                warn(str(each.message))


def warn_of_degrees(subject: str, angles: Iterable[float]) -> None:
    """Warn of finite angles beyond a whole turn, which are taken as they are [rad].

    Args:
        subject: The option or entry that has them.
        angles: [rad].
    """
    most = max((abs(angle) for angle in angles if math.isfinite(angle)), default=0.0)
    if most > 2.0 * math.pi + 1e-9:
        warn(f"{subject}: {most:g} rad is more than a whole turn: degrees? It is taken as radians")
