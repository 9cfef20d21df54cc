"""What every kind of log gives: its columns, and rows of those that are wanted."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, ClassVar

from ..key import Keys
from ..recording import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One series of numbers in a log, and what the log itself says of it."""

    name: str  # unique in the log, as messages and the study call it: "qpos[3]"
    array: str = ""  # the data set that it is an entry of: "qpos"
    index: int | None = None  # of the entry: 3
    count: int = 1  # entries of the data set
    label: str = ""  # what the log calls the entry: "elbow.pos"
    channel: str = ""  # what it is in this kind of log, unless its own words say otherwise
    unit: str = ""  # of `units.KNOWN`, where this kind of log has no other
    converted: bool = False  # to that unit by the reader, from stamps or dates
    aside: str = ""  # why it is only read where `columns:` asks for it, in words


class Log(ABC):
    """An open log. A kind of log is a subclass in a file of its own, with `register` above it.

    It finds its columns when it is opened, without reading the rows.
    """

    kind: ClassVar[str]  # as messages call it: "CSV"
    suffixes: ClassVar[tuple[str, ...]] = ()  # of its files
    magic: ClassVar[tuple[bytes, ...]] = ()  # how its files begin, where the suffix says nothing
    keys: ClassVar[Keys] = {}  # of a recording's entry that only such logs have

    columns: tuple[Column, ...] = ()
    rows: float = 0.0  # about how many
    origin: float = 0.0  # [s] that the log's times are relative to
    notes: list[str]  # what a reader of the diagnosis should know, in words

    @classmethod
    def is_folder(cls, path: Path) -> bool:
        """Whether a folder is a log of this kind."""
        return False

    @abstractmethod
    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        """Open a log.

        Args:
            path: Of the file or folder, which is there.
            name: What messages call it.
            given: What the recording's entry says under `keys`.

        Raises:
            LoadError: it is no such log.
        """

    @abstractmethod
    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        """Rows of these columns one after another, (R, c) at a time, NaN where nothing is.

        Raises:
            LoadError: it cannot be read on, or holds no numbers there.
        """

    def count(self, columns: Sequence[str]) -> float:
        """About how many rows these columns have."""
        return self.rows

    def period(self) -> float | None:
        """[s] between rows, where the log says it and no column is the time.

        Raises:
            LoadError: what it says is no such number.
        """
        return None

    def close(self) -> None:  # noqa: B027  most have nothing to close
        """Let go of the file."""

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
