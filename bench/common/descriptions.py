"""Where robots' descriptions are: those that the library ships, and those of other packages."""

from __future__ import annotations

import importlib.resources
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path


class MissingDescriptionError(Exception):
    """The Python package that holds a description is not installed."""


def shipped(name: str) -> Path:
    """A shipped robot's URDF."""
    return Path(str(importlib.resources.files("pdoik") / "robots" / f"{name}.urdf"))


def example_robot_data() -> Path:
    """The folder of its package:// addresses; the wheel has data only, no module to import.

    Raises:
        MissingDescriptionError: The package is not installed.
    """
    try:
        share = Path(str(distribution("example-robot-data").locate_file("cmeel.prefix/share")))
    except PackageNotFoundError:
        raise MissingDescriptionError("needs the Python package example-robot-data") from None
    if not (share / "example-robot-data").is_dir():
        raise MissingDescriptionError(
            f"example-robot-data is installed, but not as a wheel: no {share}"
        )
    return share


def published(file: str) -> Path:
    """A file of a robot of example-robot-data, such as go2_description/urdf/go2.urdf."""
    return example_robot_data() / "example-robot-data" / "robots" / file


def go2_urdf() -> Path:
    """Unitree's Go2."""
    return published("go2_description/urdf/go2.urdf")
