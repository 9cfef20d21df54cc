"""JSON lines: an object for each row, whose numbers may be nested, or lists with their names."""

from __future__ import annotations

import gzip
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO, cast

import numpy as np

from pdoik.errors import LoadError

from ..recording import FloatArray
from .kinds import register
from .log import Column, Log

_PEEKED = 200  # lines in which columns are looked for
_PIECE = 4096
_FEW_ROWS = 20  # fewer numbers in a list are of one row
_NAMES = ("name", "names", "joint_names", "joints")
_STAMPS = (("sec", "nanosec"), ("secs", "nsecs"))


@register
class JsonLines(Log):
    """`{"time": 0.01, "q": [0.1, 0.2]}`, or as ROS's JointState looks in JSON.

    Or one text of all: a list of such objects, or an object with a list of each.
    """

    kind = "JSON lines"
    suffixes = (".jsonl", ".ndjson", ".json", ".jsonl.gz")
    magic = (b"{",)

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        self.notes = []
        self._path, self._name = path, name
        self._whole = self._read_whole()
        columns: dict[str, Column] = {}
        bytes_read = lines = 0
        for number, row, size in self._rows():
            bytes_read, lines = bytes_read + size, number
            columns |= {c.name: c for c in _columns(row, name, number) if c.name not in columns}
            if number >= _PEEKED:
                break
        if not columns:
            raise LoadError(f"{name}: no numbers in its first {lines} lines")
        self.columns = tuple(columns.values())
        packed = 8 if path.suffix == ".gz" else 1
        guessed = packed * path.stat().st_size * lines / bytes_read
        self.rows = guessed if self._whole is None else float(len(self._whole))
        self.notes = []

    def _open(self) -> TextIO:
        if self._path.suffix == ".gz":
            return cast(TextIO, gzip.open(self._path, "rt", encoding="utf-8-sig"))
        return self._path.open(encoding="utf-8-sig")

    def _read_whole(self) -> list[dict[str, Any]] | None:
        """Rows of a file that is one JSON text; None of one with a text in each line."""
        try:
            with self._open() as file:
                first = next((line for line in file if line.strip()), "")
                second = next((line for line in file if line.strip()), "")
            if second and _is_object(first):
                return None
            with self._open() as file:
                return _rows_of(json.load(file))
        except (OSError, ValueError, RecursionError, EOFError):
            return None  # what is wrong is said when lines are read

    def _rows(self) -> Iterator[tuple[int, dict[str, Any], int]]:
        """Number, object and length of each line; one that was cut off at the end is noted."""
        if self._whole is not None:
            yield from ((k, row, 1) for k, row in enumerate(self._whole, start=1))
            return
        broken: tuple[int, Exception] | None = None
        try:
            with self._open() as file:
                for number, line in enumerate(file, start=1):
                    if broken is not None:
                        break
                    if not line.strip():
                        continue
                    try:
                        row = json.loads(line)
                    except (ValueError, RecursionError) as error:
                        broken = number, error
                        continue
                    if not isinstance(row, dict):
                        raise LoadError(
                            f"{self._name}: line {number}: expected an object such as"
                            f' {{"time": 0.01, "q": [0.1]}}, got {line.strip()[:40]!r}'
                        )
                    yield number, row, len(line)
                else:
                    if broken is not None and broken[0] > 1:
                        self.notes.append("the last line is cut off and was left out")
                        return
        except (OSError, UnicodeDecodeError, EOFError) as error:
            raise LoadError(f"{self._name}: no JSON text: {error}") from error
        if broken is not None:
            raise LoadError(
                f"{self._name}: line {broken[0]}: expected one JSON object a line: {broken[1]}"
            )

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        counts = {each.array: each.count for each in self.columns if each.index is not None}
        rows: list[list[float]] = []
        for number, row, _ in self._rows():
            values: dict[str, float] = {}
            for name, index, count, value in _numbers(row, "", self._name, number):
                if index is not None and counts.get(name, count) != count:
                    raise LoadError(
                        f"{self._name}: line {number}: {name!r} has {count} numbers, expected"
                        f" {counts[name]}"
                    )
                column = name if index is None else f"{name}[{index}]"
                if isinstance(value, str) and column in columns:
                    raise LoadError(
                        f"{self._name}: line {number}: {column!r} is {value!r}, expected a number"
                    )
                values[column] = np.nan if isinstance(value, str) else value
            rows.append([values.get(each, np.nan) for each in columns])
            if len(rows) == _PIECE:
                yield np.array(rows, dtype=np.float64)
                rows = []
        if rows:
            yield np.array(rows, dtype=np.float64)


def _is_object(line: str) -> bool:
    try:
        return isinstance(json.loads(line), dict)
    except (ValueError, RecursionError):
        return False


def _rows_of(content: Any) -> list[dict[str, Any]] | None:
    """The rows of a list of objects, or of an object with lists of the same length; else None."""
    if isinstance(content, list):
        return content if content and all(isinstance(each, dict) for each in content) else None
    if not isinstance(content, dict):
        return None
    lengths = Counter(len(each) for each in content.values() if isinstance(each, list))
    count = max(lengths, key=lambda each: (lengths[each], each), default=0)
    if count < _FEW_ROWS:
        return None
    series = {key: each for key, each in content.items() if isinstance(each, list)}
    said = {key: each for key, each in content.items() if key in _NAMES}
    rows = {key: each for key, each in series.items() if len(each) == count}
    return [{**said, **{key: each[k] for key, each in rows.items()}} for k in range(count)]


def _columns(row: dict[str, Any], name: str, line: int) -> Iterator[Column]:
    for path, index, count, value in _numbers(row, "", name, line):
        if isinstance(value, str):
            continue
        if index is None:
            yield Column(name=path)
        else:
            yield Column(name=f"{path}[{index}]", array=path, index=index, count=count)


def _numbers(
    content: Any, path: str, name: str, line: int
) -> Iterator[tuple[str, int | None, int, float | str]]:
    """Path, index in a list, the list's length, and value of each number or text in an object."""
    if isinstance(content, bool) or content is None:
        return
    if isinstance(content, int | float):
        yield path, None, 1, _float(content)
    elif isinstance(content, str):
        yield path, None, 1, content
    elif isinstance(content, dict):
        for keys in _STAMPS:
            parts = [each for key in keys if isinstance(each := content.get(key), int | float)]
            if content.keys() == set(keys) and len(parts) == len(keys):
                yield path, None, 1, parts[0] + 1e-9 * parts[1]
                return
        labels = _labels(content)
        for key, value in content.items():
            below = f"{path}.{key}" if path else key
            if labels and isinstance(value, list) and len(value) == len(labels):
                for label, each in zip(labels, value, strict=True):
                    yield from _numbers(each, f"{below}.{label}", name, line)
            else:
                yield from _numbers(value, below, name, line)
    elif isinstance(content, list):
        yield from _listed(content, path, name, line)


def _listed(
    content: list[Any], path: str, name: str, line: int
) -> Iterator[tuple[str, int | None, int, float | str]]:
    for k, each in enumerate(content):
        if isinstance(each, dict):
            label = next((each[key] for key in _NAMES if isinstance(each.get(key), str)), str(k))
            yield from _numbers(each, f"{path}.{label}", name, line)
        elif isinstance(each, int | float) and not isinstance(each, bool):
            yield path, k, len(content), _float(each)
        elif each is None:
            yield path, k, len(content), np.nan
        elif isinstance(each, str):
            yield path, k, len(content), each


def _float(number: float) -> float:
    """NaN for a whole number that no float holds."""
    try:
        return float(number)
    except OverflowError:
        return np.nan


def _labels(content: dict[str, Any]) -> list[str]:
    """Names that an object has for lists of as many numbers."""
    for key in _NAMES:
        value = content.get(key)
        if isinstance(value, list) and value and all(isinstance(each, str) for each in value):
            return value
    return []
