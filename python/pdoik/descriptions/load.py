"""One call from a file or a name to a robot."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy.typing as npt

from .._addresses import Packages
from .._core import Occupancy, Robot, load_srdf_pairs
from .._loaders import read_urdf
from ..errors import LoadError
from .root_joint import standing
from .text import RobotDescription, shipped_name

Placement = npt.ArrayLike | None
FloatingBase = tuple[npt.ArrayLike, npt.ArrayLike] | None
TipLinks = str | Sequence[str] | None


def load_robot(
    robot: str | os.PathLike[str],
    base_link: str | None = None,
    tip_link: TipLinks = None,
    *,
    T_world_base: Placement = None,
    floating_base: FloatingBase = None,
    srdf: str | os.PathLike[str] | None = None,
    hulls: bool = False,
    arguments: Mapping[str, str] | None = None,
    packages: Packages = (),
) -> Robot:
    """A robot from a URDF, xacro or MJCF file, or by name.

    Args:
        robot: A shipped robot ("panda"), a file, or an installed description ("ur5_robot"): see
            `urdf_text`. A shipped one goes first, and has its hulls.
        base_link: First link of the chain; None for the root.
        tip_link: Its end, or several; None for the only leaf.
        T_world_base: As in `Robot.from_urdf`.
        floating_base: As there.
        srdf: Pairs of links that may touch.
        hulls: Fit hulls to its collision geometry, which takes a minute or two for an arm. They are
            kept in the user's cache (`PDOIK_CACHE`), and taken from there the next time.
        arguments: Of a xacro file.
        packages: Folders of packages, by name, or folders that hold packages: see `urdf_text`.

    Raises:
        LoadError: It is not there or cannot be read.
    """
    if (shipped := shipped_name(robot)) is not None:
        loaded = Robot.builtin(
            shipped, base_link, tip_link, T_world_base=T_world_base, floating_base=floating_base
        )
        if srdf is not None:
            loaded.ignored_pairs = load_srdf_pairs(srdf, loaded)
        return loaded
    given = RobotDescription.of(robot, arguments=arguments, packages=packages)
    return load_given(given, base_link, tip_link, T_world_base, floating_base, srdf, hulls)


def load_given(
    given: RobotDescription,
    base_link: str | None,
    tip_link: TipLinks,
    T_world_base: Placement,
    floating_base: FloatingBase,
    srdf: str | os.PathLike[str] | None,
    hulls: bool,
) -> Robot:
    """`load_robot` of a description that was found."""
    with TemporaryDirectory(prefix="pdoik-meshes-") as folder:
        plain = given.kind == "urdf"
        text = given.text if plain and not hulls else given.urdf(Path(folder) if hulls else None)
        stands = standing(text)
        plain = plain and stands is text
        source = given.path or given.text if plain else stands  # messages name a file
        try:
            robot = read_urdf(
                source,
                base_link,
                tip_link,
                T_world_base=T_world_base,
                floating_base=floating_base,
                srdf=srdf,
            )
        except LoadError as error:
            raise error if plain else LoadError(f"{given.place}: {error}") from error
        if hulls:
            try:
                robot.occupancy = _hulls(text)
            except LoadError as error:
                said = f"{given.place}: no hulls: {error}; hulls=False leaves them out"
                raise LoadError(said) from error
    return robot


def _hulls(urdf: str) -> Occupancy:
    """Hulls of the geometry, link by link from the cache if it was fitted before."""
    from ..occupancy_fit import fit_occupancy

    return Occupancy.load(fit_occupancy(urdf).to_yaml())
