"""PLY files: their points, and faces of any number of corners; text, and binary of either order."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_LETTERS = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
_CORNERS = ("vertex_indices", "vertex_index")


class PlyError(ValueError):
    """What is wrong with a file, without its name."""


@dataclass(frozen=True, slots=True, eq=False)
class Ply:
    """What is read of a file.

    Attributes:
        vertices: In the file's order, (V, 3) [as the file has them]; finite or not.
        corners: Of all faces one after the other, places in `vertices`.
        counts: The corners of each face, (F,).
    """

    vertices: FloatArray
    corners: IntArray
    counts: IntArray


@dataclass(slots=True)
class _Property:
    name: str
    kind: str
    counted_by: str = ""  # the type of its length, of a list


@dataclass(slots=True)
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


@dataclass(slots=True)
class _Lists:
    """A list property: its rows one after the other, and their lengths."""

    values: npt.NDArray[np.generic]
    lengths: IntArray


_Columns = dict[str, "npt.NDArray[np.generic] | _Lists"]


def read_ply(content: bytes) -> Ply:
    """The vertices and faces of a file.

    Raises:
        PlyError: It is no PLY, cut short, has no vertices with x, y and z, or a face has a corner
            that is not there.
    """
    order, elements, start = _header(content)
    body: _Text | _Binary = _Binary(content, start, order) if order else _Text(content[start:])
    vertices, corners, counts = None, np.empty(0, np.int64), np.empty(0, np.int64)
    for element in elements:
        columns = body.read(element)
        if element.name == "vertex":
            xyz = [columns.get(axis) for axis in "xyz"]
            if any(column is None or isinstance(column, _Lists) for column in xyz):
                raise PlyError("expected vertices with x, y, z")
            vertices = np.column_stack([np.asarray(column, dtype=np.float64) for column in xyz])
        elif element.name == "face":
            lists = next((columns[name] for name in _CORNERS if name in columns), None)
            if isinstance(lists, _Lists):
                with np.errstate(invalid="ignore"):  # what is no number is no vertex's place
                    corners, counts = lists.values.astype(np.int64), lists.lengths
    if vertices is None:
        raise PlyError("expected vertices with x, y, z, got none")
    if corners.size and not (corners.min() >= 0 and corners.max() < len(vertices)):
        raise PlyError(f"a face has a corner that is none of the {len(vertices)} vertices")
    return Ply(vertices, corners, counts)


def _header(content: bytes) -> tuple[str, list[_Element], int]:
    """The order of bytes ('' for text), the elements, and where they begin."""
    order: str | None = None
    elements: list[_Element] = []
    for number, (line, after) in enumerate(_lines(content)):
        match line.split():
            case ["ply"] if number == 0:
                continue
            case _ if number == 0:
                break
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, count] if count.isdecimal() and len(count) < 16:
                elements.append(_Element(name, int(count)))
            case ["property", "list", length, kind, name] if (
                elements and _TYPES.get(length, "f")[0] != "f" and kind in _TYPES
            ):
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case ["end_header"]:
                if order is None:
                    raise PlyError("the header names no format")
                return order, elements, after
            case [] | ["comment" | "obj_info", *_]:
                continue
            case _:
                raise PlyError(f"the header has a line {line[:60]!r}")
    raise PlyError("has no PLY header")


def _lines(content: bytes) -> Iterator[tuple[str, int]]:
    """The lines of the header, and where each ends."""
    start = 0
    while (end := content.find(b"\n", start)) >= 0:
        yield content[start:end].decode("utf-8", errors="replace"), end + 1
        start = end + 1


def _cut_short(element: _Element) -> PlyError:
    return PlyError(f"the header promises {element.count} of {element.name}: the file is cut short")


class _Text:
    """The numbers of a file's text, read from the front."""

    def __init__(self, body: bytes) -> None:
        self._words = body.split()
        self._at = 0

    def read(self, element: _Element) -> _Columns:
        width = len(element.properties)
        if element.count * width > len(self._words) - self._at:
            raise _cut_short(element)
        if not any(each.counted_by for each in element.properties):
            table = self._numbers(element.count * width).reshape(element.count, width)
            return {each.name: table[:, k] for k, each in enumerate(element.properties)}
        rows: list[list[FloatArray]] = [[] for _ in element.properties]
        for _ in range(element.count):
            for column, each in zip(rows, element.properties, strict=True):
                column.append(self._numbers(self._length(element) if each.counted_by else 1))
        return _columns(element, rows)

    def _length(self, element: _Element) -> int:
        (length,) = self._numbers(1)
        if not 0 <= length <= len(self._words) - self._at:
            raise _cut_short(element)
        return int(length)

    def _numbers(self, count: int) -> FloatArray:
        words = self._words[self._at : self._at + count]
        self._at += count
        if len(words) < count:
            raise PlyError("the file is cut short")
        try:
            return np.array(words, dtype=np.float64)
        except ValueError:
            raise PlyError("expected numbers after the header") from None


class _Binary:
    """The numbers of a file's bytes, read from the front."""

    def __init__(self, content: bytes, start: int, order: str) -> None:
        self._content, self._at, self._order = content, start, order

    def read(self, element: _Element) -> _Columns:
        if not element.properties or not element.count:
            return _columns(element, [[] for _ in element.properties])
        # Most files have faces of one kind: then all rows are as long as the first.
        lengths = self._lengths_of_first(element)
        parts = [
            self._parts(k, *both)
            for k, both in enumerate(zip(element.properties, lengths, strict=True))
        ]
        layout = np.dtype([field for each in parts for field in each])
        end = self._at + element.count * layout.itemsize
        if end <= len(self._content):
            table = np.frombuffer(self._content, layout, element.count, self._at)
            alike = [
                (table[f"length{k}"] == lengths[k]).all()
                for k, each in enumerate(element.properties)
                if each.counted_by
            ]
            if all(alike):
                self._at = end
                return {
                    each.name: _Lists(table[f"value{k}"].ravel(), np.full(len(table), lengths[k]))
                    if each.counted_by
                    else table[f"value{k}"]
                    for k, each in enumerate(element.properties)
                }
        return self._row_by_row(element)

    def _parts(
        self, k: int, each: _Property, length: int
    ) -> list[tuple[str, str, tuple[int, ...]]]:
        """A property's fields of a row's layout."""
        kind = self._order + each.kind
        if not each.counted_by:
            return [(f"value{k}", kind, ())]
        return [(f"length{k}", self._order + each.counted_by, ()), (f"value{k}", kind, (length,))]

    def _lengths_of_first(self, element: _Element) -> list[int]:
        start, lengths = self._at, []
        for each in element.properties:
            lengths.append(self._length(each, element) if each.counted_by else 1)
            self._at += lengths[-1] * int(each.kind[1])
        self._at = start
        return lengths

    def _row_by_row(self, element: _Element) -> _Columns:
        least = sum(int((each.counted_by or each.kind)[1]) for each in element.properties)
        if element.count * least > len(self._content) - self._at:
            raise _cut_short(element)
        rows: list[list[tuple[float, ...]]] = [[] for _ in element.properties]
        for _ in range(element.count):
            for column, each in zip(rows, element.properties, strict=True):
                length = self._length(each, element) if each.counted_by else 1
                column.append(self._unpacked(each.kind, length, element))
        return _columns(element, rows)

    def _length(self, each: _Property, element: _Element) -> int:
        (length,) = self._unpacked(each.counted_by, 1, element)
        if not 0 <= length * int(each.kind[1]) <= len(self._content) - self._at:
            raise _cut_short(element)
        return int(length)

    def _unpacked(self, kind: str, count: int, element: _Element) -> tuple[float, ...]:
        if self._at + count * int(kind[1]) > len(self._content):
            raise _cut_short(element)
        numbers = struct.unpack_from(
            f"{self._order}{count}{_LETTERS[kind]}", self._content, self._at
        )
        self._at += count * int(kind[1])
        return numbers


def _columns(element: _Element, rows: Sequence[Sequence[npt.ArrayLike]]) -> _Columns:
    """Rows of each property, put together."""
    columns: _Columns = {}
    for each, column in zip(element.properties, rows, strict=True):
        values = np.concatenate([np.empty(0), *map(np.asarray, column)])
        lengths = np.array([np.size(row) for row in column], dtype=np.int64)
        columns[each.name] = _Lists(values, lengths) if each.counted_by else values
    return columns
