"""MATLAB's files of version 5 to 7: variables, and fields of structures, as arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdoik.errors import LoadError

from ..recording import FloatArray
from .arrays import Place, blocks_of, check_lengths, columns_of, names_in, period_in, pieces_of
from .kinds import register
from .log import Column, Log

_NEWER = b"MATLAB 7.3 MAT-file"


@register
class Matlab(Log):
    """Variables (T,), (T, n) or (n, T) by name; `joint_names`, `dt` or `fps`, too."""

    kind = "MATLAB"
    suffixes = (".mat",)
    magic = (b"MATLAB 5.0 MAT-f",)

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        from scipy.io import loadmat

        self.notes = []
        self._name = name
        try:
            with path.open("rb") as file:
                newer = file.read(len(_NEWER)) == _NEWER
            content = {} if newer else loadmat(str(path), simplify_cells=True)
        except Exception as error:  # of a damaged file SciPy raises many kinds
            raise LoadError(f"{name}: no MATLAB file: {error}") from error
        if newer:
            raise LoadError(f"{name}: of version 7.3; expected one of save(..., '-v7')")
        series: dict[str, Any] = {}
        self._said: dict[str, Any] = {}
        for key, value in _variables(content, ""):
            if np.ndim(value) in (1, 2) and np.asarray(value).dtype.kind in "iufb":
                series[key] = np.asarray(value)
            else:
                self._said[key.rpartition(".")[2]] = value
        self._arrays = _upright(series)
        names = names_in(self._said)
        columns: dict[Column, Place] = {}
        for key, values in self._arrays.items():
            columns |= columns_of(key, values.shape, (), names)
        if not columns:
            raise LoadError(f"{name}: no variables of numbers, (T,) or (T, n)")
        self.columns = tuple(columns)
        self._places = {column.name: place for column, place in columns.items()}

    def count(self, columns: Sequence[str]) -> float:
        return float(max(len(self._arrays[self._places[each].array]) for each in columns))

    def period(self) -> float | None:
        return period_in(self._name, self._said)

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        places = [self._places[each] for each in columns]
        arrays = {each.array: self._arrays[each.array] for each in places}
        check_lengths(self._name, {key: len(values) for key, values in arrays.items()})
        yield from pieces_of({key: blocks_of(values) for key, values in arrays.items()}, places)


def _variables(content: Mapping[str, Any], path: str) -> Iterator[tuple[str, Any]]:
    """Variables and fields of structures by their paths."""
    for key, value in content.items():
        if key.startswith("__"):
            continue
        below = f"{path}.{key}" if path else key
        if isinstance(value, dict):
            yield from _variables(value, below)
        else:
            yield below, value


def _upright(series: Mapping[str, Any]) -> dict[str, Any]:
    """The series with time along the first axis: the length that most arrays have."""
    lengths = Counter(length for values in series.values() for length in set(values.shape))
    rows = max(lengths, key=lambda each: (lengths[each], each), default=0)
    return {
        key: values.T if values.ndim == 2 and values.shape[0] != rows == values.shape[1] else values
        for key, values in series.items()
    }
