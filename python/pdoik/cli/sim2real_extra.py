"""What the commands that need the extra sim2real say without it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from .messages import fail


@contextmanager
def extra_needed(command: str) -> Iterator[None]:
    """Turn a missing package of others into what to install, and status 2."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] == "pdoik":
            raise
        fail(f"pdoik {command} needs {error.name}: pip install 'pdoik[sim2real]'")
