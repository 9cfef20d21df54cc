"""Descriptions that other packages bring, by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from .._addresses import Places
from ..errors import LoadError

_SHARE = "cmeel.prefix/share/example-robot-data/robots"
_MODULES = "robot_descriptions"


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """A file of an installed package, and what its reader needs to know."""

    path: Path
    arguments: Mapping[str, str] = field(default_factory=dict)  # of a xacro file
    packages: Places = field(default_factory=Places)


def names() -> list[str]:
    """What is known without a network, for messages."""
    return [*_example_robot_data(), *_menagerie()]


def description_of(name: str) -> Description | None:
    """A description by its name; None where no installed package has it.

    Asked are example-robot-data, robot_descriptions and mujoco-menagerie, in this order.

    Raises:
        LoadError: One has it, and could not get its files.
    """
    if (file := _example_robot_data().get(name)) is not None:
        return Description(path=file)
    failed = []
    for source in (_of_robot_descriptions, _of_menagerie):
        try:
            if (found := source(name)) is not None:
                return found
        except LoadError as error:  # the other one may have it
            failed.append(str(error))
    if failed:
        raise LoadError("; ".join(failed))
    return None


def _example_robot_data() -> dict[str, Path]:
    """Files by name: that of the file, with or without a last _robot, or of its folder.

    A folder means the file that is called as it, or the only one there.
    """
    try:
        share = Path(str(distribution("example-robot-data").locate_file(_SHARE)))
    except PackageNotFoundError:
        return {}
    found: dict[str, Path] = {}
    for folder in sorted(share.glob("*")):
        files = {
            file.stem: file
            for part in ("robots", "urdf", ".")
            for file in sorted(folder.glob(f"{part}/*.urdf"))
            if file.stat().st_size
        }
        found |= files
        for stem, file in files.items():
            if stem.endswith("_robot"):
                found.setdefault(stem.removesuffix("_robot"), file)
        short = folder.name.removesuffix("_description")
        main = files.get(short) or (next(iter(files.values())) if len(files) == 1 else None)
        if main is not None:
            found.setdefault(short, main)
            found.setdefault(folder.name, main)
    return found


def _of_robot_descriptions(name: str) -> Description | None:
    for module in (name, f"{name}_description", f"{name}_mj_description"):
        if not module.isidentifier():
            continue
        full = f"{_MODULES}.{module}"
        try:
            found = import_module(full)
        except Exception as error:  # it clones a repository when it is imported
            if isinstance(error, ModuleNotFoundError) and error.name in (full, _MODULES):
                continue
            raise LoadError(f"robot_descriptions could not get {module}: {error}") from error
        for kind in ("URDF_PATH", "XACRO_PATH", "MJCF_PATH"):
            if path := getattr(found, kind, None):
                package = Path(found.PACKAGE_PATH)
                named = getattr(found, "XACRO_PACKAGE_PATHS", {})
                return Description(
                    path=Path(path),
                    arguments=getattr(found, "XACRO_ARGS", {}),
                    packages=Places(
                        named={key: Path(folder) for key, folder in named.items()},
                        holding=(package, package.parent, Path(found.REPOSITORY_PATH)),
                    ),
                )
    return None


def _menagerie() -> dict[str, str]:
    """Robots of a package by name, and by that of their model where one is called so: ur5e."""
    try:
        robots = import_module("mujoco_menagerie").robots()
    except ModuleNotFoundError:
        return {}
    models = [robot.default_model for robot in robots]
    short = {r.default_model: r.name for r in robots if models.count(r.default_model) == 1}
    return {**short, **{robot.name: robot.name for robot in robots}}


def _of_menagerie(name: str) -> Description | None:
    if (known := _menagerie().get(name)) is None:
        return None
    robot = import_module("mujoco_menagerie").get(known)
    try:
        return Description(path=robot.xml(robot.default_model))
    except Exception as error:  # it gets an archive from the network
        raise LoadError(f"mujoco-menagerie could not get {known}: {error}") from error
