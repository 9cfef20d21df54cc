"""What a world's file has of the robot itself, which is no obstacle: known by names."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pdoik._core import Robot

FloatArray = npt.NDArray[np.float64]

WORLD = "world"
_VIRTUAL = frozenset(f"base_{axis}" for axis in ("x", "y", "z", "yaw", "pitch", "roll"))
_STILL = 1e-9  # how far a link's frame may move between two configurations and stand still


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnLinks:
    """A robot's names.

    Attributes:
        base_link: Whose frame obstacles are to be in.
        joints: Those that move a tip or a hull, but not those that a floating base stands on.
        moved: Links that these move against the base link.
        still: The others, the base link among them.
        hulls: Links that it has hulls for.
    """

    base_link: str
    joints: frozenset[str]
    moved: frozenset[str]
    still: frozenset[str]
    hulls: frozenset[str]

    @classmethod
    def of(cls, robot: Robot) -> OwnLinks:
        """A robot's own links and joints.

        A joint that moves neither a tip nor a hull, such as a door's in a file that the robot was
        read from whole, is not the robot's.
        """
        hulls = _hulled(robot)
        held = np.random.default_rng(0).uniform(0.1, 0.2, robot.dof)
        matter = {*robot.tip_links, *hulls}
        is_own = np.array(
            [bool(_moved(robot, held, held + row, matter)) for row in 0.2 * np.eye(robot.dof)]
        )
        moved = _moved(robot, held, held + 0.2 * is_own, robot.link_names)
        return cls(
            base_link=robot.base_link,
            moved=moved,
            still=frozenset(robot.link_names) - moved,
            joints=frozenset(np.array(robot.joint_names)[is_own].tolist()) - _VIRTUAL,
            hulls=hulls,
        )

    @staticmethod
    def is_half_of(own: Collection[str], found: Collection[str]) -> bool:
        """Whether half of the robot's names are among those of a file, and one at least."""
        count = sum(name in found for name in own)
        return count > 0 and 2 * count >= len(own)


def _hulled(robot: Robot) -> frozenset[str]:
    """Links that hulls are on."""
    occupancy = robot.occupancy
    found = {link for link, *_ in occupancy.spheres} | {link for link, *_ in occupancy.capsules}
    for one, _, other, *_ in occupancy.spheroids:
        found |= {one, other}
    return frozenset(found)


def _moved(
    robot: Robot, q: FloatArray, other: FloatArray, links: Collection[str]
) -> frozenset[str]:
    """Which of these links stand elsewhere in another configuration."""
    return frozenset(
        link for link in links if np.abs(robot.fk(q, link) - robot.fk(other, link)).max() > _STILL
    )
