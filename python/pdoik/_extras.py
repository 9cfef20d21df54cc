"""What needs more than NumPy says which extra to install where a package is missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pdoik.errors import MissingExtraError


@contextmanager
def asks_for(extra: str) -> Iterator[None]:
    """Within it, or in a function that it decorates, a package that is missing names its extra.

    Args:
        extra: of pyproject.toml, with everything that the code within imports.

    Raises:
        MissingExtraError: A package of others is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "pdoik").partition(".")[0]
        if package == "pdoik" or isinstance(error, MissingExtraError):
            raise
        raise MissingExtraError(package, extra) from error
