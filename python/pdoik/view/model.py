"""The robot on the page: kinematics, hulls, and what it looks like."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import pdoik
from pdoik._addresses import Packages
from pdoik.errors import RobotWarning

from .body import body_visuals
from .humanoid import is_h1
from .visuals import load_visuals


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Model:
    """A robot and where it came from.

    Attributes:
        robot: Kinematics and hulls.
        urdf: Its file; None for a built-in robot.
        packages: As in `pdoik.urdf_text`.
        visuals: A GLB file by link.
        notes: What could not be had.
    """

    robot: pdoik.Robot
    urdf: Path | None = None
    packages: Packages = ()
    visuals: dict[str, bytes] = field(default_factory=dict)
    notes: Sequence[str] = ()

    def with_tip(self, tip_link: str | None) -> Model:
        """The same file with another tip; None for every leaf.

        Raises:
            LoadError: There is no such link.
        """
        assert self.urdf is not None, "built-in robots have one tip"
        robot = read_robot(self.urdf, self.robot.base_link, tip_link)
        robot.occupancy = self.robot.occupancy
        return replace(self, robot=robot)

    def with_hulls(self, occupancy: pdoik.Occupancy) -> Model:
        """The same robot in other hulls.

        Raises:
            ValueError: They are of another robot.
        """
        robot = self.robot.__copy__()
        robot.occupancy = occupancy
        return replace(self, robot=robot)


def builtin_model(name: str) -> Model:
    """A robot shipped with the library."""
    return shipped_model(pdoik.Robot.builtin(name))


def shipped_model(robot: pdoik.Robot) -> Model:
    """A robot shipped with the library, seen from any links; the H1 has the shapes of its parts."""
    return Model(robot=robot, visuals=body_visuals(robot) if is_h1(robot) else {})


def urdf_model(robot: pdoik.Robot, urdf: Path, packages: Packages = ()) -> Model:
    """A robot that was read from a file, with the meshes that can be found.

    Raises:
        LoadError: The file cannot be read.
    """
    visuals, missing = load_visuals(urdf, packages)
    known = set(robot.link_names)
    return Model(
        robot=robot,
        urdf=urdf,
        packages=packages,
        visuals={link: glb for link, glb in visuals.items() if link in known},
        notes=missing,
    )


def read_robot(
    urdf: Path, base_link: str | None = None, tip_link: str | None = None
) -> pdoik.Robot:
    """A URDF's robot; its oddities are for `pdoik info` to report.

    Raises:
        LoadError: The file or a link in it cannot be had.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        return pdoik.Robot.from_urdf(urdf, base_link=base_link, tip_link=tip_link)


def deepest_tip(robot: pdoik.Robot) -> str:
    """The tip that most joints move."""
    q = robot.mid_configuration()

    def movers(tip: str) -> int:
        return int((abs(robot.jacobian(q, tip)).max(axis=0) > 1e-12).sum())

    return max(robot.tip_links, key=movers)
