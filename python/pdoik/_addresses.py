"""Where the files are that robots and scenes name: paths, `file://` and `package://` addresses."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from urllib.parse import unquote

from .errors import LoadError

StrPath = str | os.PathLike[str]
_VARIABLES = (
    *("PDOIK_PACKAGE_PATH", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"),
    *("GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH"),
)
_SCHEME = re.compile(r"(package|model|file)://(.*)", re.DOTALL)
_NAMED = re.compile(r"<name>\s*([^<\s]+)\s*</name>")
_IN_URDF = re.compile(
    r"""(<\s*(?:mesh|texture)\b[^<>]*?\bfilename\s*=\s*)(?:"([^"]*)"|'([^']*)')"""
)
_QUOTES = {'"': "&quot;", "'": "&apos;"}


@dataclass(frozen=True, slots=True)
class Places:
    """Where files are looked for.

    Attributes:
        named: Folders of packages by their names, which nothing else is asked for then.
        holding: Folders that hold packages, or are one; files of plain names may be in them, too.
        file: The file that names the others; None for text.
    """

    named: Mapping[str, Path] = field(default_factory=dict)
    holding: tuple[Path, ...] = ()
    file: Path | None = None
    _manifests: dict[Path, list[tuple[str, Path]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    @classmethod
    def of(cls, given: Packages = (), file: Path | None = None) -> Places:
        """The places that are given, and those around a file.

        Raises:
            LoadError: What is given is no folder.
        """
        if isinstance(given, Places):
            return given.before(cls(file=file))
        if isinstance(given, Mapping):
            named = {name: at_home(folder) for name, folder in given.items()}
            for name, folder in named.items():
                if not folder.is_dir():
                    raise LoadError(f"package {name!r} is said to be in {folder}: no such folder")
            return cls(named=named, file=file)
        folders = [given] if isinstance(given, str | os.PathLike) else given or ()
        holding = tuple(at_home(folder) for folder in folders)
        for folder in holding:
            if not folder.is_dir():
                raise LoadError(f"packages are said to be in {folder}: no such folder")
        return cls(holding=holding, file=file)

    def before(self, others: Places) -> Places:
        """These places, and after them others."""
        named = {**others.named, **self.named}
        return Places(named, (*self.holding, *others.holding), self.file or others.file)

    def package(self, name: str) -> Path:
        """A package's folder.

        Raises:
            LoadError: It is nowhere.
        """
        for folder in self._packages(name):
            return folder
        raise LoadError(self._missing(name))

    def find(self, address: str) -> Path:
        """The file that an address means.

        Paths are absolute or relative to the file that has them. What is in none of the packages
        may be next to that file by its last parts: others' absolute paths, packages without a name.

        Raises:
            LoadError: It is nowhere.
        """
        candidates: Iterator[Path]
        scheme = _SCHEME.fullmatch(address)
        kind, rest = scheme.groups() if scheme else ("", address)
        if kind in ("package", "model"):
            name, _, inside = rest.partition("/")
            candidates = (folder / inside for folder in self._packages(name))
        else:
            name = inside = ""
            texts = (rest, unquote(rest))
            whole = (Path(text) for text in texts if Path(text).is_absolute())
            candidates = chain(whole, (p / text for text in texts for p in self._around()))
        strict = name in self.named  # what is given is not overruled
        for path in chain(candidates, () if strict else self._by_last_parts(rest)):
            if is_file(path):
                return path
        raise LoadError(f"{address!r}: {self._why_not(name, inside)}")

    def _why_not(self, package: str, inside: str) -> str:
        if not package:
            around = " or ".join(map(str, self._around()))
            return f"no such file{' in ' if around else ''}{around}"
        tried = [str(folder / inside) for folder in self._packages(package)]
        return f"{' and '.join(tried)}: no such file" if tried else self._missing(package)

    def _packages(self, name: str) -> Iterator[Path]:
        """The folders that may be a package's, the likeliest first."""
        if name in self.named:
            yield self.named[name]
            return
        for place in self.holding:
            yield from self._within(place, name, deep=True)
        for variable in _VARIABLES:
            for text in filter(None, os.environ.get(variable, "").split(os.pathsep)):
                yield from self._within(Path(text), name, deep=variable != "AMENT_PREFIX_PATH")
        for above in self._above():
            yield from self._within(above, name, deep=False)

    def _within(self, place: Path, name: str, *, deep: bool) -> Iterator[Path]:
        """A folder that is the package, or packages of that name in it; deep: some folders down."""
        if place.name == name and place.is_dir():
            yield place
        for folder in (place / name, place / "share" / name):
            if name and folder.is_dir():
                yield folder
        if _name_in(place / "package.xml") == name:  # folders need not be called as the package
            yield place
        if deep:
            if place not in self._manifests:
                self._manifests[place] = _packages_below(place)
            yield from (folder for named, folder in self._manifests[place] if named == name)

    def _around(self) -> list[Path]:
        return [*([] if self.file is None else [self.file.parent]), *self.holding]

    def _above(self) -> list[Path]:
        if self.file is None:
            return []
        return [*dict.fromkeys([*self.file.absolute().parents, *self.file.resolve().parents])]

    def _by_last_parts(self, rest: str) -> list[Path]:
        if self.file is None:
            return []
        parts = Path(rest).parts
        return [self.file.parent / Path(*parts[k:]) for k in range(1, len(parts))]

    def _missing(self, name: str) -> str:
        where = [*map(str, self.holding), *(v for v in _VARIABLES if os.environ.get(v))]
        where += [] if self.file is None else [f"the folders above {self.file}"]
        return (
            f"package {name!r} is nowhere{' in ' if where else ''}{', '.join(where)}: give its"
            f" folder, packages={{{name!r}: FOLDER}} or --package-dir {name}=FOLDER, or put the"
            f" folder above it into {_VARIABLES[0]}"
        )


Packages = Mapping[str, StrPath] | Sequence[StrPath] | Places | None
"""Folders of packages by their names, or folders that hold packages."""


def at_home(path: StrPath) -> Path:
    """A path with its first ~ expanded.

    Raises:
        LoadError: There is no such home.
    """
    try:
        return Path(path).expanduser()
    except RuntimeError as error:
        raise LoadError(f"{path}: there is no such home folder") from error


def with_paths(text: str, places: Places) -> str:
    """A URDF whose meshes are named by absolute paths, as far as they are found."""
    from xml.sax.saxutils import escape, unescape  # imports HTTP, which takes long

    def replaced(match: re.Match[str]) -> str:
        address = unescape(
            match.group(2) or match.group(3) or "", {v: k for k, v in _QUOTES.items()}
        )
        try:
            path = places.find(address).resolve().as_posix()
        except LoadError:
            return match.group(0)
        return f'{match.group(1)}"{escape(path, _QUOTES)}"'

    return _IN_URDF.sub(replaced, text)


def _packages_below(place: Path) -> list[tuple[str, Path]]:
    found = [each for stars in ("*", "*/*", "*/*/*") for each in place.glob(f"{stars}/package.xml")]
    return [(name, each.parent) for each in sorted(found) if (name := _name_in(each))]


def _name_in(manifest: Path) -> str | None:
    try:
        named = _NAMED.search(manifest.read_text("utf-8", errors="replace"))
    except OSError:
        return None
    return None if named is None else named.group(1)


def is_file(path: Path) -> bool:
    """Whether it is there as a file; no name is too long to ask."""
    with suppress(OSError):
        return path.is_file()
    return False


def is_folder(path: Path) -> bool:
    """The same of a folder."""
    with suppress(OSError):
        return path.is_dir()
    return False
