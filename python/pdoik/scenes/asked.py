"""What a caller asks of a scene's file, and what a reader gives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pdoik._addresses import Packages
from pdoik._core import Attachment, ContactRule
from pdoik.scenes.own_links import OwnLinks
from pdoik.scenes.pieces import Thing
from pdoik.scenes.values import EntryError

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What `load_scene` was asked for.

    Attributes:
        packages: Where files are that the scene's names.
        frame: Whose frame is the base frame; None for the robot's base link, or the world.
        own: The robot that is left out; None if nobody named it.
        without: Names of objects that are left out.
        keyframe: Where what moves stands.
    """

    packages: Packages = ()
    frame: str | None = None
    own: OwnLinks | None = None
    without: tuple[str, ...] = ()
    keyframe: str | int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class World:
    """What a file holds.

    Attributes:
        things: Its objects, in the base frame.
        contacts: Rules of contact.
        attached: What is attached to links.
        left_out: What the file has besides them, in words: the robot, and what cannot be touched.
        surface: The points of its cloud as their file has them, (N, 3) [m]; no rows without one.
        leaf: Edge of the cells the cloud is to be thinned to [m]; 0 keeps every point.
        radii: Whether points that are kept cover those that are not.
    """

    things: tuple[Thing, ...]
    contacts: tuple[ContactRule, ...] = ()
    attached: tuple[Attachment, ...] = ()
    left_out: tuple[str, ...] = ()
    surface: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    leaf: float = 0.0
    radii: bool = False


def check_names(asked: Iterable[str], known: Iterable[str], what: str, file: Path) -> None:
    """Look whether what is to be left out is there.

    Raises:
        EntryError: Names the first that is not, and what there is.
    """
    names = list(dict.fromkeys(known))
    for name in asked:
        if name not in names:
            raise EntryError(file, f"there is no {what} {name!r} to be left out: {some(names)}")


def some(names: Iterable[str]) -> str:
    """The first few of many names."""
    listed = list(names)
    more = f" and {len(listed) - 8} more" if len(listed) > 8 else ""
    return (", ".join(listed[:8]) or "none") + more
