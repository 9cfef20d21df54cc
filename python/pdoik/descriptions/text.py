"""The URDF of whatever a robot is given as."""

from __future__ import annotations

import difflib
import hashlib
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from .._core import Robot
from .._files import write_whole
from ..errors import LoadError
from .installed import installed, path_of
from .packages import with_packages
from .xacro_file import expanded

_ROOT = re.compile(r"<\s*(mujoco|robot)\b")
_XACRO = "http://www.ros.org/wiki/xacro"


def urdf_text(
    robot: str | os.PathLike[str],
    *,
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    meshes: str | os.PathLike[str] | None = None,
) -> str:
    """A robot's URDF.

    Args:
        robot: A URDF, xacro or MJCF file, or the name of an installed description: `ur5_robot`,
            `go2` (the package example-robot-data), `panda_mj_description` (robot_descriptions).
        arguments: Of a xacro file.
        packages: Folders by the name of the package, for `package://NAME/...` and `$(find NAME)`.
            Those that are not here are looked for in the folders of ROS_PACKAGE_PATH,
            AMENT_PREFIX_PATH and PDOIK_PACKAGE_PATH, and above the file itself.
        meshes: Folder for the meshes of an MJCF, which its URDF names; without it, it has none.

    Raises:
        LoadError: There is no such file or description, or it cannot be read.
    """
    return urdf_of(Given.of(robot), arguments or {}, packages or {}, meshes)


def urdf_of(
    given: Given,
    arguments: Mapping[str, str],
    packages: Mapping[str, str | os.PathLike[str]],
    meshes: str | os.PathLike[str] | None,
) -> str:
    """`urdf_text` of a file that was found and read."""
    if arguments and given.kind != "xacro":
        raise LoadError(f"{given.path}: arguments are of xacro files, and this is none")
    if given.kind == "mjcf":
        from .mjcf import urdf_of_mjcf

        return urdf_of_mjcf(given.path, None if meshes is None else Path(meshes))
    plain = given.kind == "urdf"
    text = given.text if plain else expanded(given.path, arguments, packages)
    return with_packages(text, given.path, packages)


def urdf_file(robot: str | os.PathLike[str]) -> Path:
    """A URDF of `urdf_text` as a file: the robot's own, or one in the user's cache with its meshes.

    Raises:
        LoadError: As there.
    """
    given = Given.of(robot)
    if given.kind == "urdf":
        return given.path
    digest = hashlib.sha256(f"{given.path.resolve()}\n{given.text}".encode()).hexdigest()
    folder = cache() / "urdf" / digest[:16]
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{given.path.name.partition('.')[0]}.urdf"
    write_whole(file, urdf_of(given, {}, {}, folder))
    return file


def cache() -> Path:
    """The user's folder of what was made once."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pdoik"


@dataclass(frozen=True, slots=True)
class Given:
    """A robot's file as it was found."""

    path: Path
    text: str
    kind: str  # mjcf, xacro or, as far as one look tells, urdf

    @classmethod
    def of(cls, robot: str | os.PathLike[str]) -> Given:
        """Of a file or a name.

        Raises:
            LoadError: There is none, or it cannot be read.
        """
        path = _found(robot)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise LoadError(f"cannot read {path}: {error}") from error
        root = _ROOT.search(text)
        if root is not None and root.group(1) == "mujoco":
            return cls(path, text, "mjcf")
        return cls(path, text, "xacro" if path.suffix == ".xacro" or _XACRO in text else "urdf")


def _found(robot: str | os.PathLike[str]) -> Path:
    path = Path(robot).expanduser()
    if path.is_file():
        return path
    name = str(robot)
    if path.suffix or os.sep in name:
        raise LoadError(f"no such file: {path}")
    named = path_of(name)
    if named is not None:
        return named
    shipped = Robot.builtin_names()
    known = [*shipped, *installed()]
    longer = [each for each in known if each.startswith(name)]  # with a version, or of a variant
    near = longer[:5] or difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    said = f"; nearest: {', '.join(near)}" if near else ""
    raise LoadError(
        f"no robot {name!r}: expected a file, one of {', '.join(shipped)}, or a description of"
        f" example-robot-data or robot_descriptions, where they are installed{said}"
    )
