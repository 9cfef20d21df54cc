"""Descriptions that other packages bring, by name."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from ..errors import LoadError

_SHARE = "cmeel.prefix/share/example-robot-data/robots"


def installed() -> dict[str, Path]:
    """Files of example-robot-data by name: that of the file, with or without a last _robot.

    Also that of its folder, where it is the only one there.
    """
    try:
        share = Path(str(distribution("example-robot-data").locate_file(_SHARE)))
    except PackageNotFoundError:
        return {}
    found: dict[str, Path] = {}
    for folder in sorted(share.glob("*")):
        files = sorted(
            file for part in ("robots", "urdf", ".") for file in folder.glob(f"{part}/*.urdf")
        )
        found |= {file.stem: file for file in files if file.stat().st_size}
        for file in files:
            if file.stem.endswith("_robot"):
                found.setdefault(file.stem.removesuffix("_robot"), file)
        if len(files) == 1:
            found.setdefault(folder.name.removesuffix("_description"), files[0])
    return found


def path_of(name: str) -> Path | None:
    """The file of a description; None where no installed package has it.

    Raises:
        LoadError: robot_descriptions has it, and could not get its files.
    """
    if name in (known := installed()):
        return known[name]
    for module in (name, f"{name}_description", f"{name}_mj_description"):
        try:
            found = import_module(f"robot_descriptions.{module}")
        except ModuleNotFoundError:
            continue
        except Exception as error:  # it clones a repository when it is imported
            raise LoadError(f"robot_descriptions could not get {module}: {error}") from error
        return Path(getattr(found, "URDF_PATH", None) or found.MJCF_PATH)
    return None
