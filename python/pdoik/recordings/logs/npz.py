"""NumPy's .npz files: an array for each channel, or records. No pickles are opened."""

from __future__ import annotations

import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.lib import format as npy

from pdoik.errors import LoadError

from ..key import Keys
from ..recording import FloatArray
from .arrays import (
    ENV,
    ROWS,
    Place,
    check_lengths,
    columns_of,
    env_of,
    names_in,
    period_in,
    pieces_of,
)
from .kinds import register
from .log import Column, Log

_BROKEN = (  # what zipfile and NumPy raise of a damaged file
    *(zipfile.BadZipFile, zlib.error, OSError, EOFError, NotImplementedError, OverflowError),
    *(ValueError, TypeError, KeyError, SyntaxError, tokenize.TokenError),
)


@register
class Npz(Log):
    """Arrays (T,), (T, n) and (T, E, n), and records (T,), by name; `joint_names`, `dt`, too."""

    kind = "NPZ"
    suffixes = (".npz",)
    magic = (b"PK\x03\x04",)
    keys: ClassVar[Keys] = {"env": ENV}

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        self.notes = []
        self._name = name
        self._shapes: dict[str, tuple[int, ...]] = {}
        self._places: dict[str, Place] = {}
        try:
            self._zip = zipfile.ZipFile(path)
        except _BROKEN as error:
            raise LoadError(f"{name}: no NPZ file: {error}") from error
        try:
            self._open(env_of(name, given))
        except LoadError:
            self.close()
            raise
        except _BROKEN as error:
            self.close()
            raise LoadError(f"{name}: no NPZ file: {error}") from error

    def _open(self, env: int | None) -> None:
        series: dict[str, np.dtype[Any]] = {}
        said: dict[str, Any] = {}
        pickled = []
        for member in self._zip.namelist():
            array = member.removesuffix(".npy")
            with self._zip.open(member) as file:
                shape, _, dtype = _header(file)
            if dtype.hasobject:
                pickled.append(array)
            elif not shape or dtype.kind in "US":
                with self._zip.open(member) as file:
                    said[array] = npy.read_array(file, allow_pickle=False)
            elif dtype.kind in "iufb" or dtype.names:
                series[array], self._shapes[array] = dtype, shape
        names = names_in(said)
        columns: dict[Column, Place] = {}
        for array, dtype in series.items():
            fields = [each for each in dtype.names or () if dtype[each].kind in "iufb"]
            columns |= columns_of(array, self._shapes[array], fields, names, env=env)
        if not columns:
            objects = f"; {', '.join(pickled)} hold Python objects, which are not read"
            raise LoadError(f"{self._name}: no arrays of numbers{objects if pickled else ''}")
        if pickled:
            self.notes.append(f"arrays of Python objects are not read: {', '.join(pickled)}")
        self.columns = tuple(columns)
        self._places = {column.name: place for column, place in columns.items()}
        self._said = said

    def count(self, columns: Sequence[str]) -> float:
        return float(max(self._shapes[self._places[each].array][0] for each in columns))

    def period(self) -> float | None:
        return period_in(self._name, self._said)

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        places = [self._places[each] for each in columns]
        arrays = list(dict.fromkeys(each.array for each in places))
        check_lengths(self._name, {array: self._shapes[array][0] for array in arrays})
        try:
            yield from pieces_of({array: self._blocks(array) for array in arrays}, places)
        except _BROKEN as error:
            raise LoadError(f"{self._name}: cannot be read on: {error}") from error

    def _blocks(self, array: str) -> Iterator[Any]:
        """Rows of one array at a time; the whole of one whose columns are stored one by one."""
        with self._zip.open(f"{array}.npy") as file:
            shape, by_columns, dtype = _header(file)
            if by_columns and len(shape) > 1:
                size = int(np.prod(shape)) * dtype.itemsize
                whole = np.frombuffer(_exactly(file, size), dtype).reshape(shape, order="F")
                for k in range(0, shape[0], ROWS):
                    yield whole[k : k + ROWS]
                return
            row = dtype.itemsize * int(np.prod(shape[1:]))
            for k in range(0, shape[0], ROWS):
                count = min(ROWS, shape[0] - k)
                block = np.frombuffer(_exactly(file, count * row), dtype)
                yield block.reshape(count, *shape[1:])

    def close(self) -> None:
        self._zip.close()


def _header(file: Any) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether its columns are stored one by one, and type."""
    version = npy.read_magic(file)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, by_columns, dtype = read(file)
    return tuple(shape), bool(by_columns), dtype


def _exactly(file: Any, size: int) -> bytes:
    found = bytes(file.read(size))
    if len(found) != size:
        raise EOFError("it ends too early")
    return found
