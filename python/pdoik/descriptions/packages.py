"""Where packages of `package://` addresses are."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

_ADDRESS = re.compile(r"package://([^/\"']+)")
_VARIABLES = ("PDOIK_PACKAGE_PATH", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")


def package_folder(
    name: str, beside: Path, told: Mapping[str, str | os.PathLike[str]]
) -> Path | None:
    """A package's folder; None where it is nowhere.

    Args:
        name: of the package.
        beside: the file that names it: the package may be a folder above it, or beside one.
        told: folders by name, which go first.
    """
    if name in told:
        return Path(told[name])
    places = [Path(p) for v in _VARIABLES for p in os.environ.get(v, "").split(os.pathsep) if p]
    for place in places:
        for folder in (place / name, place / "share" / name, place):
            if folder.name == name and folder.is_dir():
                return folder
    for above in beside.resolve().parents:
        if above.name == name:
            return above
        if (above / name).is_dir():
            return above / name
    return None


def with_packages(text: str, beside: Path, told: Mapping[str, str | os.PathLike[str]]) -> str:
    """Addresses of packages that were found as absolute paths; others stay as they are."""

    def replaced(match: re.Match[str]) -> str:
        folder = package_folder(match.group(1), beside, told)
        return match.group(0) if folder is None else folder.resolve().as_posix()

    return _ADDRESS.sub(replaced, text)
