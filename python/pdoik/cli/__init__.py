"""The command line: pdoik solve, info, occupancy, bench, view, diagnose and the others."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from . import interrupts

if TYPE_CHECKING:
    from .commands import app

__all__ = ["app", "main"]


def main() -> None:
    """The command `pdoik`, which Ctrl-C ends with a line and status 130 from here on."""
    interrupts.take_over()
    try:
        from .commands import app
    except ModuleNotFoundError as error:
        print(
            f"error: the command line needs {error.name}: pip install 'pdoik[cli]'",
            file=sys.stderr,
        )
        sys.exit(2)

    app(prog_name="pdoik")


def __getattr__(name: str) -> Any:
    """`app`, imported when it is asked for: that takes long, and Ctrl-C has to be heard before."""
    if name != "app":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .commands import app

    return app
