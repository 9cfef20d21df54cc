"""Where a robot's links and hulls are at a configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pdoik import Robot

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedHull:
    """A sphere (foci that coincide) or spheroid in the base frame."""

    name: str
    focus_a: FloatArray  # (3,), [m]
    focus_b: FloatArray  # (3,), [m]
    semi_major: float  # [m]

    def gap(self, points: FloatArray) -> FloatArray:
        """Half the sum of distances to the foci, minus a (Eq. link_coll_avoid), (N,) [m].

        Positive outside; never more than the distance to the hull.
        """
        to_a = np.linalg.norm(points - self.focus_a, axis=1)
        to_b = np.linalg.norm(points - self.focus_b, axis=1)
        return np.asarray((to_a + to_b) / 2 - self.semi_major, dtype=np.float64)


def placed_hulls(robot: Robot, q: FloatArray) -> list[PlacedHull]:
    """The robot's hulls at `q`, spheres first."""
    poses = {link: robot.fk(q, link) for link in robot.link_names}

    def place(link: str, local: tuple[float, float, float]) -> FloatArray:
        return np.asarray(poses[link][:3, :3] @ np.array(local) + poses[link][:3, 3])

    spheres = [
        PlacedHull(
            name=link,
            focus_a=place(link, center),
            focus_b=place(link, center),
            semi_major=radius,
        )
        for link, center, radius in robot.occupancy.spheres
    ]
    spheroids = [
        PlacedHull(
            name=link_a if link_a == link_b else f"{link_a} to {link_b}",
            focus_a=place(link_a, focus_a),
            focus_b=place(link_b, focus_b),
            semi_major=semi_major,
        )
        for link_a, focus_a, link_b, focus_b, semi_major in robot.occupancy.spheroids
    ]
    return spheres + spheroids


def gaps(hulls: list[PlacedHull], points: FloatArray) -> FloatArray:
    """The gap of each point to its nearest hull, (N,) [m]; infinite without hulls."""
    nearest = np.full(len(points), np.inf)
    for hull in hulls:
        np.minimum(nearest, hull.gap(points), out=nearest)
    return nearest


def way_to(robot: Robot, q: FloatArray, tip: str) -> list[str]:
    """Base, first link behind each joint on the way to the tip, and tip.

    A link lies on the way when only joints that move the tip move it.
    """

    def movers(link: str) -> frozenset[int]:
        return frozenset(
            np.flatnonzero(np.abs(robot.jacobian(q, link)).max(axis=0) > 1e-12).tolist()
        )

    tip_movers = movers(tip)
    first: dict[frozenset[int], str] = {frozenset(): robot.base_link}
    for link in robot.link_names:
        joints = movers(link)
        if joints <= tip_movers:
            first.setdefault(joints, link)
    return [first[joints] for joints in sorted(first, key=len)] + [tip]


def skeleton(robot: Robot, q: FloatArray, tip: str) -> FloatArray:
    """Origins of the links on the way to the tip that do not coincide, (K, 3) [m]."""
    origins = np.array([robot.fk(q, link)[:3, 3] for link in way_to(robot, q, tip)])
    moved = np.linalg.norm(np.diff(origins, axis=0), axis=1) > 1e-9
    return np.asarray(origins[np.concatenate([[True], moved])])
