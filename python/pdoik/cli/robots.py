"""Robots named on the command line."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer

import pdoik
from pdoik._addresses import Places
from pdoik.errors import RobotWarning

from .messages import fail, misuse_fails, warn
from .options import ROBOT

BUILTIN = tuple(pdoik.Robot.builtin_names())
ANY_ROBOT = f"{', '.join(BUILTIN)}, a URDF, xacro or MJCF file, or an installed description"

RobotArgument = Annotated[str, typer.Argument(help=f"{ANY_ROBOT}.", metavar="ROBOT")]
PackageDirs = Annotated[
    list[str] | None,
    typer.Option(
        "--package-dir",
        help="NAME=FOLDER of a package of package:// addresses or $(find), or a folder that holds"
        " packages; repeatable.",
        metavar="[NAME=]FOLDER",
        rich_help_panel=ROBOT,
    ),
]
XacroArguments = Annotated[
    list[str] | None,
    typer.Option(
        "--xacro-arg",
        help="Argument of a xacro file; repeatable.",
        metavar="NAME:=VALUE",
        rich_help_panel=ROBOT,
    ),
]


def load_robot(
    name: str,
    base_link: str | None = None,
    tip_link: str | Sequence[str] | None = None,
    occupancy: Path | None = None,
    srdf: Path | None = None,
    *,
    packages: Sequence[str] | None = None,
    arguments: Sequence[str] | None = None,
) -> pdoik.Robot:
    """A robot by name, or of a URDF, xacro or MJCF file; leaves with status 2 otherwise."""
    places, values = package_places(packages), xacro_arguments(arguments)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", RobotWarning)
        with misuse_fails():
            robot = pdoik.load_robot(
                name, base_link, tip_link or None, arguments=values, packages=places
            )
    for each in said:
        if str(each.message) not in robot.warnings:  # those are for pdoik info to report
            warn(str(each.message))
    if occupancy is not None:
        with misuse_fails(f"--occupancy {occupancy}"):
            robot.occupancy = pdoik.Occupancy.load(str(occupancy))
    if srdf is not None:
        with misuse_fails(f"--srdf {srdf}"):
            robot.ignored_pairs = pdoik.load_srdf_pairs(srdf, robot)
    return robot


def described(
    robot: str,
    packages: Sequence[str] | None,
    arguments: Sequence[str] | None,
    meshes: str | None = None,
) -> str:
    """A robot's URDF; the meshes of an MJCF are put into a folder, or left out."""
    return pdoik.urdf_text(
        robot,
        arguments=xacro_arguments(arguments),
        packages=package_places(packages),
        meshes=meshes,
    )


def package_places(given: Sequence[str] | None) -> Places:
    """Places that --package-dir gives."""
    pairs = [text.partition("=") for text in given or () if "=" in text]
    folders = [text for text in given or () if "=" not in text]
    with misuse_fails("--package-dir"):
        named = Places.of({name: folder for name, _, folder in pairs})
        return named.before(Places.of(folders))


def xacro_arguments(given: Sequence[str] | None) -> dict[str, str]:
    """Arguments that --xacro-arg gives."""
    pairs = [(text, *text.partition(":=")) for text in given or ()]
    for text, name, sign, _ in pairs:
        if not (name and sign):
            fail(f"--xacro-arg: expected NAME:=VALUE, got {text!r}")
    return {name: value for _, name, _, value in pairs}


def numbers(text: str, robot: pdoik.Robot) -> npt.NDArray[np.float64]:
    """A configuration from words, (n,) [rad] or [m].

    Raises:
        ValueError: They are not as many numbers as the robot has joints.
    """
    words = text.replace(",", " ").split()
    try:
        q = np.array([float(word) for word in words])
    except ValueError:
        raise ValueError(f"expected {robot.dof} numbers, got {text!r}") from None
    if len(q) != robot.dof:
        raise ValueError(f"expected {robot.dof} numbers, one per joint, got {len(q)}")
    return q
