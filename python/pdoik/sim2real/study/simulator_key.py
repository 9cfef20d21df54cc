"""What a study says of the user's simulator: `simulator: {mjcf: model.xml, ...}`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from .key_tables import SIMULATOR
from .keys import checked, text
from .simulator_file import SimulatorFile

_FILES = ("mjcf", "urdf")


def simulator_from(content: Any, folder: Path) -> SimulatorFile | None:
    """The study's `simulator`; None without one.

    Raises:
        LoadError: an unknown key, no file, or both of an MJCF and a URDF.
    """
    if content is None:
        return None
    keys = checked(content, SIMULATOR, "simulator")
    named = [key for key in _FILES if keys.get(key) is not None]
    if len(named) != 1:
        raise LoadError(
            "simulator: expected one of 'mjcf: model.xml' and 'urdf: robot.urdf' (with the study's"
            f" 'controller:'), got {' and '.join(named) or 'neither'}"
        )
    file = text(keys[named[0]], f"simulator: {named[0]}")
    path = folder / Path(str(file)).expanduser()
    if not path.is_file():
        names = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"simulator: no such file: {path}{nearest(path.name, names)}")
    actuators = keys.get("actuators") or {}
    if not isinstance(actuators, dict):
        raise LoadError(
            f"simulator: actuators: expected 'joint: actuator' lines, got {actuators!r}"
        )
    return SimulatorFile(
        path=path,
        format=named[0],
        actuators={str(joint): str(actuator) for joint, actuator in actuators.items()},
    )
