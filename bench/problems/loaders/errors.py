"""What a loader says when it refuses."""

from __future__ import annotations

from pathlib import Path


class LoaderError(RuntimeError):
    """A file that cannot be read as a problem set: names the file and the entry."""

    def __init__(self, file: Path, what: str, entry: str = "") -> None:
        super().__init__(f"{file}: {entry + ': ' if entry else ''}{what}")
