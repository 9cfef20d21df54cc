"""Files that are read while they are written: they grow, are replaced, cut off, or followed."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray, Reading

from .csv_stream import CsvStream

_PIECE = 1 << 20  # bytes read at a time
SUFFIXES = (".csv", ".tsv", ".txt")

Piece = tuple[str, dict[str, FloatArray] | None]
"""A log's name and columns of its next rows; None where another clock may begin."""


class Tail:
    """One file by its name, whatever file has it."""

    def __init__(self, path: Path, joints: Sequence[str], reading: Reading | None = None) -> None:
        """Nothing is opened yet."""
        self.path = path
        self.stream = CsvStream(path.name, joints, reading)
        self._file: BinaryIO | None = None

    def read(self) -> Iterator[Piece]:
        """All that is there now.

        Raises:
            LoadError: the file cannot be read, or holds no such log.
        """
        while True:
            if self._file is None and not self._open():
                return
            file = self._file
            assert file is not None
            if os.fstat(file.fileno()).st_size < file.tell():  # cut off, and written anew
                file.seek(0)
                self.stream.begin()
                yield self.path.name, None
            while piece := file.read(_PIECE):
                for columns in self.stream.add(piece):
                    yield self.path.name, columns
            if not self._replaced(file):
                return
            self.close()
            yield self.path.name, None

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            self._file.close()
        self._file = None

    def _open(self) -> bool:
        try:
            self._file = self.path.open("rb")
        except FileNotFoundError:
            return False  # renamed, and its successor is not there yet
        except OSError as error:
            raise LoadError(f"{self.path}: {error.strerror}") from None
        self.stream.begin()
        return True

    def _replaced(self, file: BinaryIO) -> bool:
        """Whether the name is that of another file now."""
        try:
            now, before = self.path.stat(), os.fstat(file.fileno())
        except OSError:
            return False
        return (now.st_ino, now.st_dev) != (before.st_ino, before.st_dev)


class Folder:
    """Logs that are written into a folder, one after the other.

    A file is followed until a newer one is there and nothing more comes; then it is done with.
    """

    def __init__(self, path: Path, joints: Sequence[str], reading: Reading | None = None) -> None:
        """The folder is there."""
        self.path = path
        self._joints, self._reading = joints, reading
        self._done: set[str] = set()
        self._tail: Tail | None = None

    def read(self) -> Iterator[Piece]:
        """All that is there now."""
        while True:
            waiting = self._waiting()
            if self._tail is None:
                if not waiting:
                    return
                self._tail = Tail(waiting[0], self._joints, self._reading)
                continue
            yield from self._tail.read()
            if not waiting:
                return
            self._tail.close()
            self._done.add(self._tail.path.name)
            yield self._tail.path.name, None
            self._tail = None

    def close(self) -> None:
        """Let go of the file."""
        if self._tail is not None:
            self._tail.close()

    def _waiting(self) -> list[Path]:
        """Logs that are not begun, the oldest first."""
        current = "" if self._tail is None else self._tail.path.name
        found = {}
        for each in self.path.iterdir():
            if each.suffix in SUFFIXES and not each.name.startswith("."):
                try:
                    found[each] = each.stat().st_mtime_ns
                except FileNotFoundError:
                    continue
        self._done &= {each.name for each in found}  # as many names as there are files
        new = [each for each in found if each.name not in (*self._done, current)]
        return sorted(new, key=lambda each: (found[each], each.name))
