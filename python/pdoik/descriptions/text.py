"""The URDF of whatever a robot is given as."""

from __future__ import annotations

import difflib
import hashlib
import os
import re
from collections.abc import Mapping
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
    path = _found(robot)
    kind = _kind(path)
    if arguments and kind != "xacro":
        raise LoadError(f"{path}: arguments are of xacro files, and this is none")
    if kind == "mjcf":
        from .mjcf import urdf_of_mjcf

        return urdf_of_mjcf(path, None if meshes is None else Path(meshes))
    text = _read(path) if kind == "urdf" else expanded(path, arguments or {}, packages or {})
    return with_packages(text, path, packages or {})


def plain_urdf(robot: str | os.PathLike[str]) -> Path | None:
    """The file of a robot that has a URDF already; None where one must be made.

    Raises:
        LoadError: As `urdf_text`.
    """
    path = _found(robot)
    return path if _kind(path) == "urdf" else None


def urdf_file(robot: str | os.PathLike[str]) -> Path:
    """A URDF of `urdf_text` as a file: the robot's own, or one in the user's cache with its meshes.

    Raises:
        LoadError: As there.
    """
    if (plain := plain_urdf(robot)) is not None:
        return plain
    path = _found(robot)
    digest = hashlib.sha256(f"{path.resolve()}\n{_read(path)}".encode()).hexdigest()
    folder = cache() / "urdf" / digest[:16]
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{path.name.partition('.')[0]}.urdf"
    write_whole(file, urdf_text(path, meshes=folder))
    return file


def cache() -> Path:
    """The user's folder of what was made once."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pdoik"


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise LoadError(f"cannot read {path}: {error}") from error


def _kind(path: Path) -> str:
    """Whether a file is MJCF, xacro or, as far as one look tells, a URDF."""
    text = _read(path)
    root = _ROOT.search(text)
    if root is not None and root.group(1) == "mujoco":
        return "mjcf"
    return "xacro" if path.suffix == ".xacro" or _XACRO in text else "urdf"


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
    near = difflib.get_close_matches(name, [*shipped, *installed()], n=3, cutoff=0.5)
    said = f"; nearest: {', '.join(near)}" if near else ""
    raise LoadError(
        f"no robot {name!r}: expected a file, one of {', '.join(shipped)}, or a description of"
        f" example-robot-data or robot_descriptions, where they are installed{said}"
    )
