"""Files that are either written whole or not at all."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

unfinished: set[Path] = set()
"""Temporary files that are being written, for who ends the process in the midst of it."""


@contextmanager
def renamed_when_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary name next to `path` to write to; what is there at the end gets its name."""
    target = Path(path)
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    unfinished.add(temporary)
    try:
        yield temporary
        temporary.chmod(target.stat().st_mode if target.exists() else 0o666 & ~_umask())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
        unfinished.discard(temporary)


def write_whole(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write to a temporary name next to `path`, then rename it: nobody ever reads half a file."""
    with renamed_when_whole(path) as temporary, temporary.open("xb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
        file.flush()
        os.fsync(file.fileno())


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
