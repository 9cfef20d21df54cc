"""HDF5 files: data sets for channels, or the demonstrations of robomimic and Isaac Lab."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..key import Key, Keys
from ..recording import FloatArray
from .arrays import (
    ENV,
    Place,
    blocks_of,
    check_lengths,
    columns_of,
    env_of,
    names_in,
    period_in,
    pieces_of,
)
from .kinds import register
from .log import Column, Log

_ARTICULATIONS = "states/articulation/"  # where Isaac Lab keeps what the simulator's joints did
_OF_POLICY = "a policy's observations may be relative to a pose; the states next to them are not"
_BROKEN = (OSError, RuntimeError, KeyError, ValueError, TypeError)  # h5py of a damaged file
_SHOWN = 5
_WORDS = 200  # more texts are no names of joints


@register
class Hdf5(Log):
    """Data sets (T,), (T, n) or of records, in the whole file or below one group.

    A group is given by `group`, or as one of several demonstrations `demo_0`, ... by `demo`. Names
    of joints, `dt` or `fps` may be attributes or data sets of the group or of any above.
    """

    kind = "HDF5"
    suffixes = (".h5", ".hdf5", ".hdf")
    magic = (b"\x89HDF\r\n\x1a\n",)
    keys: ClassVar[Keys] = {
        "demo": Key("a whole number", "which demonstration of a file", "3", "the only one"),
        "group": Key("a path", "of an HDF5 file's group", "/robot/arm", "the whole file"),
        "env": ENV,
    }

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        try:
            import h5py
        except ImportError as error:
            raise LoadError(f"{name}: HDF5 needs h5py: pip install h5py") from error
        self.notes = []
        self._name = name
        try:
            self._file: Any = h5py.File(path, "r")
        except _BROKEN as error:
            raise LoadError(f"{name}: no HDF5 file: {error}") from error
        try:
            self._group = self._chosen(given)
            self._open(env_of(name, given))
        except LoadError:
            self.close()
            raise
        except _BROKEN as error:
            self.close()
            raise LoadError(f"{name}: no HDF5 file: {error}") from error

    def _chosen(self, given: Mapping[str, Any]) -> Any:
        """The group whose data sets are read."""
        if "group" in given:
            return self._at(str(given["group"]), "group")
        demos = _demonstrations(self._file)
        if "demo" in given:
            if not demos:
                raise LoadError(f"{self._name}: demo: it has no demonstrations 'demo_0', ...")
            said = str(given["demo"])
            for each in (said, f"demo_{said}"):
                if each in demos:
                    return self._file[demos[each]]
            raise LoadError(
                f"{self._name}: demo: no demonstration {said!r}{nearest(f'demo_{said}', demos)};"
                f" it has {_listed(list(demos))}"
            )
        if len(demos) > 1:
            raise LoadError(
                f"{self._name}: {len(demos)} demonstrations: {_listed(list(demos))}; say which"
                f" with 'demo:'"
            )
        return self._file[next(iter(demos.values()))] if demos else self._file

    def _at(self, path: str, key: str) -> Any:
        import h5py

        found = self._file.get(path)
        if not isinstance(found, h5py.Group):
            groups: list[str] = []
            self._file.visititems(
                lambda each, item: groups.append(each) if isinstance(item, h5py.Group) else None
            )
            raise LoadError(f"{self._name}: {key}: no group {path!r}{nearest(path, groups)}")
        return found

    def _open(self, env: int | None) -> None:
        import h5py

        found: dict[str, Any] = {}

        def visit(path: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.shape and item.dtype.kind in "iufbV":
                found[path] = item

        self._group.visititems(visit)
        states = any(path.startswith(_ARTICULATIONS) for path in found)
        columns: dict[Column, Place] = {}
        self._sets: dict[str, Any] = {}
        for path, item in found.items():
            fields = [e for e in item.dtype.names or () if item.dtype[e].kind in "iufb"]
            own = {str(key): value for key, value in item.attrs.items()}
            new = columns_of(
                path,
                item.shape,
                fields,
                names_in(own) or self._names_above(item),
                str(own.get("unit", own.get("units", ""))),
                _OF_POLICY if states and path.startswith("obs/") else "",
                env,
            )
            columns |= new
            self._sets |= {path: item} if new else {}
        if not columns:
            raise LoadError(f"{self._name}: no data sets of numbers, (T,) or (T, n)")
        self.columns = tuple(columns)
        self._places = {column.name: place for column, place in columns.items()}

    def count(self, columns: Sequence[str]) -> float:
        return float(max(self._sets[self._places[each].array].shape[0] for each in columns))

    def period(self) -> float | None:
        found = (period_in(self._name, said) for said in self._said_above(self._group))
        return next((each for each in found if each is not None), None)

    def _names_above(self, item: Any) -> tuple[str, ...]:
        """Names of joints in the data set's groups, the nearest that has as many."""
        for said in self._said_above(item.parent):
            names = names_in(said)
            if len(item.shape) == 2 and len(names) == item.shape[1]:
                return names
        return ()

    def _said_above(self, group: Any) -> Iterator[dict[str, Any]]:
        """Attributes, single numbers and texts of a group and of those above it."""
        import h5py

        while True:
            said: dict[str, Any] = {str(key): value for key, value in group.attrs.items()}
            for key, item in group.items():
                if isinstance(item, h5py.Dataset) and _is_said(item):
                    said.setdefault(key, item[()])
            yield said
            if group.name == "/":
                return
            group = group.parent

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        places = [self._places[each] for each in columns]
        sets = {each.array: self._sets[each.array] for each in places}
        check_lengths(self._name, {array: item.shape[0] for array, item in sets.items()})
        try:
            yield from pieces_of({array: blocks_of(item) for array, item in sets.items()}, places)
        except _BROKEN as error:
            raise LoadError(f"{self._name}: cannot be read on: {error}") from error

    def close(self) -> None:
        self._file.close()


def _demonstrations(file: Any) -> dict[str, str]:
    """Paths of demonstrations by their names, of `data/` or of the file, in their order."""
    above = file["data"] if "data" in file and hasattr(file["data"], "items") else file
    found = {
        key: f"{above.name}/{key}".replace("//", "/")
        for key, item in above.items()
        if hasattr(item, "items") and key.partition("_")[0] in ("demo", "episode", "traj")
    }
    return dict(sorted(found.items(), key=lambda each: (len(each[0]), each[0])))


def _is_said(item: Any) -> bool:
    """Whether a data set is a number or a few words."""
    return item.shape == () or (item.dtype.kind in "OSU" and 0 < item.size <= _WORDS)


def _listed(names: Sequence[str]) -> str:
    more = len(names) - _SHOWN
    return ", ".join(names[:_SHOWN]) + (f" and {more} more" if more > 0 else "")
