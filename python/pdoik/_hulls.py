"""Where a robot's links and hulls are at a configuration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pdoik import Robot

FloatArray = npt.NDArray[np.float64]
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedSpheroid:
    """A sphere (foci that coincide) or spheroid in the base frame."""

    name: str
    focus_a: FloatArray  # (3,), [m]
    focus_b: FloatArray  # (3,), [m]
    semi_major: float  # [m]
    fills: bool = True  # False: it only says where to look for its link's capsules

    @property
    def ends(self) -> FloatArray:
        """Foci of the spheroid, (2, 3) [m]."""
        return np.array([self.focus_a, self.focus_b])

    @property
    def extent(self) -> float:
        """No part of it is farther from the middle of its ends [m]."""
        return self.semi_major

    def gap(self, points: FloatArray) -> FloatArray:
        """Half the sum of distances to the foci, minus a (Eq. link_coll_avoid), (N,) [m].

        Positive outside; never more than the distance to the hull.
        """
        to_a = np.linalg.norm(points - self.focus_a, axis=1)
        to_b = np.linalg.norm(points - self.focus_b, axis=1)
        return np.asarray((to_a + to_b) / 2 - self.semi_major, dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedCapsule:
    """What lies within a radius of a segment, in the base frame."""

    name: str
    a: FloatArray  # (3,), [m]
    b: FloatArray  # (3,), [m]
    radius: float  # [m]
    fills: bool = True

    @property
    def ends(self) -> FloatArray:
        """Ends of the segment, (2, 3) [m]."""
        return np.array([self.a, self.b])

    @property
    def extent(self) -> float:
        """No part of it is farther from the middle of its ends [m]."""
        return float(np.linalg.norm(self.b - self.a)) / 2 + self.radius

    def gap(self, points: FloatArray) -> FloatArray:
        """Distance to it, negative inside, (N,) [m]."""
        v = self.b - self.a
        t = np.clip((points - self.a) @ v / max(float(v @ v), 1e-300), 0, 1)
        nearest = self.a + t[:, None] * v
        return np.asarray(np.linalg.norm(points - nearest, axis=1) - self.radius)


PlacedHull = PlacedSpheroid | PlacedCapsule


def placed_hulls(robot: Robot, q: FloatArray) -> list[PlacedHull]:
    """The robot's hulls at `q` as the occupancy numbers them: spheres, spheroids, capsules."""
    poses = {link: robot.fk(q, link) for link in robot.link_names}
    wide = wide_hulls(robot)

    def place(link: str, local: Point) -> FloatArray:
        return np.asarray(poses[link][:3, :3] @ np.array(local) + poses[link][:3, 3])

    balls = [(link, c, link, c, radius) for link, c, radius in robot.occupancy.spheres]
    spheroids = [
        PlacedSpheroid(
            name=link_a if link_a == link_b else f"{link_a} to {link_b}",
            focus_a=place(link_a, focus_a),
            focus_b=place(link_b, focus_b),
            semi_major=semi_major,
            fills=k not in wide,
        )
        for k, (link_a, focus_a, link_b, focus_b, semi_major) in enumerate(
            [*balls, *robot.occupancy.spheroids]
        )
    ]
    capsules = [
        PlacedCapsule(name=link, a=place(link, a), b=place(link, b), radius=radius)
        for link, a, b, radius, _ in robot.occupancy.capsules
    ]
    return [*spheroids, *capsules]


def hull_names(robot: Robot) -> list[str]:
    """What results call each hull, in the order of `placed_hulls`."""
    occupancy = robot.occupancy
    names = [f"{link} (sphere {k})" for k, (link, *_) in enumerate(occupancy.spheres)]
    for k, (link_a, _, link_b, *_) in enumerate(occupancy.spheroids):
        link = link_a if link_a == link_b else f"{link_a} to {link_b}"
        names.append(f"{link} (spheroid {k})")
    names += [f"{link} (capsule {k})" for k, (link, *_) in enumerate(occupancy.capsules)]
    return names


def one_hull(robot: Robot, q: FloatArray, number: int) -> PlacedHull:
    """The hull of that number, as `placed_hulls` has it but for `fills`."""

    def place(link: str, local: Point) -> FloatArray:
        T = robot.fk(q, link)
        return np.asarray(T[:3, :3] @ np.array(local) + T[:3, 3])

    occupancy = robot.occupancy
    spheres, spheroids = len(occupancy.spheres), len(occupancy.spheroids)
    if number >= spheres + spheroids:
        link, a, b, radius, _ = occupancy.capsules[number - spheres - spheroids]
        return PlacedCapsule(name=link, a=place(link, a), b=place(link, b), radius=radius)
    if number < spheres:
        link, xyz, radius = occupancy.spheres[number]
        center = place(link, xyz)
        return PlacedSpheroid(name=link, focus_a=center, focus_b=center, semi_major=radius)
    link_a, xyz_a, link_b, xyz_b, semi_major = occupancy.spheroids[number - spheres]
    return PlacedSpheroid(
        name=link_a if link_a == link_b else f"{link_a} to {link_b}",
        focus_a=place(link_a, xyz_a),
        focus_b=place(link_b, xyz_b),
        semi_major=semi_major,
    )


def wide_hulls(robot: Robot) -> frozenset[int]:
    """Numbers of the spheres and spheroids that are rigid to a link with capsules.

    These say where to look for the link's capsules, which are what it fills.
    """
    occupancy = robot.occupancy
    with_capsules = {link for link, *_ in occupancy.capsules}
    if not with_capsules:
        return frozenset()

    def owner(link_a: str, a: Point, link_b: str, b: Point) -> str | None:
        if _is_carried(robot, link_a, link_b, b):
            return link_a
        return link_b if _is_carried(robot, link_b, link_a, a) else None

    owners: list[str | None] = [link for link, *_ in occupancy.spheres]
    owners += [owner(*hull[:4]) for hull in occupancy.spheroids]
    return frozenset(k for k, link in enumerate(owners) if link in with_capsules)


def _is_carried(robot: Robot, by: str, link: str, local: Point) -> bool:
    """Whether a point of a link stays where it is to another, as on the axis of their joint."""
    if by == link:
        return True
    rng = np.random.default_rng(0)
    seen = [
        np.linalg.solve(robot.fk(q, by), robot.fk(q, link) @ [*local, 1.0])
        for q in rng.uniform(-1, 1, (3, robot.dof))  # any: limits do not matter here
    ]
    return bool(np.ptp(seen, axis=0).max() < 1e-9)


def gaps(hulls: Sequence[PlacedHull], points: FloatArray) -> FloatArray:
    """The gap of each point to the nearest hull that the robot fills, (N,) [m]; infinite without.

    What only says where to look for capsules is left out.
    """
    nearest = np.full(len(points), np.inf)
    for hull in hulls:
        if hull.fills:
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
