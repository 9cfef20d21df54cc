"""What long commands report of their work while it goes on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from .messages import err

Tell = Callable[[str, str, float], None]


def share_bar() -> Progress:
    """Bar of the share of work that is done; only on a terminal, and it vanishes at the end."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        console=err,
        transient=True,
        disable=not err.is_terminal,
    )


@contextmanager
def story(*, quiet: bool = False) -> Iterator[Tell]:
    """A bar, and above it what was found out so far, line by line; without these if `quiet`."""
    with share_bar() as progress:
        task = progress.add_task("", total=1.0)

        def tell(stage: str, text: str, fraction: float) -> None:
            progress.update(task, description=escape(stage), completed=min(max(fraction, 0.0), 1.0))
            if text and not quiet:
                err.print(f"[bold]{escape(stage)}[/]  {escape(text)}", highlight=False)

        yield tell
