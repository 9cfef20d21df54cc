"""Robots named on the command line."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.errors import RobotWarning

from .messages import misuse_fails

BUILTIN = tuple(pdoik.Robot.builtin_names())
ANY_ROBOT = f"{', '.join(BUILTIN)}, a URDF, xacro or MJCF file, or an installed description"


def load_robot(
    name: str,
    base_link: str | None = None,
    tip_link: str | Sequence[str] | None = None,
    occupancy: Path | None = None,
    srdf: Path | None = None,
) -> pdoik.Robot:
    """A robot by name, or of a URDF, xacro or MJCF file; leaves with status 2 otherwise."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)  # pdoik info tells them
        with misuse_fails():
            robot = pdoik.load_robot(name, base_link, tip_link or None)
    if occupancy is not None:
        with misuse_fails(f"--occupancy {occupancy}"):
            robot.occupancy = pdoik.Occupancy.load(str(occupancy))
    if srdf is not None:
        with misuse_fails(f"--srdf {srdf}"):
            robot.ignored_pairs = pdoik.load_srdf_pairs(srdf, robot)
    return robot


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
