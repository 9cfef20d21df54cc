"""Numbers as JSON that keeps every bit, and entries of a file that say what is wrong with them."""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoadError

FloatArray = NDArray[np.float64]
_NO_NUMBERS = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}  # which JSON has not


def plain(value: Any) -> Any:
    """Arrays and tuples as lists, what is not finite as a word: what strict JSON has."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value


def packed(values: NDArray[np.float32]) -> dict[str, Any]:
    """Many numbers in single precision as `Entry.packed` reads them.

    Their bytes in four planes, which differ less than numbers do, by zlib and base64.
    """
    planes = np.ascontiguousarray(values).view(np.uint8).reshape(-1, 4).T
    text = base64.b64encode(zlib.compress(planes.tobytes(), 6)).decode("ascii")
    return {"shape": list(values.shape), "float32": text}


def json_lines(value: Any, indent: int = 0) -> str:
    """JSON for people: a line for each entry, and for each row of a table."""
    inner = " " * (indent + 1)
    if isinstance(value, Mapping) and value:
        lines = [f"{inner}{_scalar(k)}: {json_lines(v, indent + 1)}" for k, v in value.items()]
        return "{\n" + ",\n".join(lines) + "\n" + " " * indent + "}"
    if isinstance(value, list) and any(isinstance(each, list | Mapping) for each in value):
        lines = [inner + json_lines(each, indent + 1) for each in value]
        return "[\n" + ",\n".join(lines) + "\n" + " " * indent + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)


@dataclass(frozen=True, slots=True)
class Entry:
    """A value in a file, by its name."""

    value: Any
    file: str
    name: str = ""

    def wrong(self, what: str) -> LoadError:
        """An error that says where."""
        return LoadError(
            f"{self.file}: {self.name}: {what}" if self.name else f"{self.file}: {what}"
        )

    def expected(self, what: str) -> LoadError:
        """An error that says what came instead."""
        got = repr(self.value)
        return self.wrong(f"expected {what}, got {got if len(got) < 60 else got[:57] + '...'}")

    def __getitem__(self, key: str) -> Entry:
        if not isinstance(self.value, Mapping):
            raise self.expected("entries by name")
        name = f"{self.name}.{key}" if self.name else key
        if key not in self.value:
            raise Entry(None, self.file, name).wrong("is missing")
        return Entry(self.value[key], self.file, name)

    def get(self, key: str) -> Entry:
        """Entry as by brackets; with the value None where there is none."""
        if not isinstance(self.value, Mapping):
            raise self.expected("entries by name")
        return self[key] if key in self.value else Entry(None, self.file, f"{self.name}.{key}")

    def names(self) -> list[str]:
        """Names of a mapping's entries."""
        if not isinstance(self.value, Mapping):
            raise self.expected("entries by name")
        return list(self.value)

    def items(self) -> list[Entry]:
        """A list's entries."""
        if not isinstance(self.value, list):
            raise self.expected("a list")
        return [Entry(v, self.file, f"{self.name}[{k}]") for k, v in enumerate(self.value)]

    def text(self, *choices: str) -> str:
        """A str, one of the choices if there are any."""
        if not isinstance(self.value, str) or (choices and self.value not in choices):
            raise self.expected(f"one of {', '.join(choices)}" if choices else "a text")
        return self.value

    def boolean(self) -> bool:
        if not isinstance(self.value, bool):
            raise self.expected("true or false")
        return self.value

    def whole(self) -> int:
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.expected("a whole number")
        return self.value

    def number(self) -> float:
        if isinstance(self.value, str) and self.value in _NO_NUMBERS:
            return _NO_NUMBERS[self.value]
        if not isinstance(self.value, int | float) or isinstance(self.value, bool):
            raise self.expected("a number")
        return float(self.value)

    def array(self, *shape: int | None, nan: bool = False) -> FloatArray:
        """Numbers of a shape, of which None stands for any length."""
        says = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
        try:
            found = np.array(self.value, dtype=np.float64)
        except (TypeError, ValueError):
            raise self.expected(f"numbers of shape {says}") from None
        if found.size == 0 and None in shape:
            found = found.reshape([n or 0 for n in shape])
        fits = found.ndim == len(shape) and all(
            n in (None, m) for n, m in zip(shape, found.shape, strict=True)
        )
        if not fits:
            raise self.wrong(f"expected numbers of shape {says}, got {found.shape}")
        if not nan and np.isnan(found).any():
            raise self.wrong(f"expected numbers of shape {says}, got NaN or null among them")
        return found

    def packed(self, dimensions: int) -> NDArray[np.float32]:
        """What `packed` made of an array of so many dimensions."""
        shape = [each.whole() for each in self["shape"].items()]
        text = self["float32"].text()
        if len(shape) != dimensions or min(shape) < 1:
            raise self["shape"].expected(f"{dimensions} lengths")
        size = 4 * math.prod(shape)
        try:
            unpacker = zlib.decompressobj()
            planes = unpacker.decompress(base64.b64decode(text, validate=True), size)
        except (ValueError, zlib.error) as error:
            raise self["float32"].wrong(f"cannot be unpacked: {error}") from None
        if len(planes) != size or not (unpacker.eof or not unpacker.unconsumed_tail):
            raise self["float32"].wrong(f"expected {size} bytes, got {len(planes)}")
        numbers = np.frombuffer(planes, np.uint8).reshape(4, -1).T
        return np.ascontiguousarray(numbers).view(np.float32).reshape(shape)

    def array_or_none(self, *shape: int | None) -> FloatArray | None:
        """As `array`, or None."""
        return None if self.value is None else self.array(*shape)


def by_name(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Dict of pairs for json: a name given twice is an error, not the last one."""
    found = dict(pairs)
    if len(found) != len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the entry {twice!r} is given twice")
    return found
