"""Robots by their description alone: of it the library makes its robot and the judge its own."""

from __future__ import annotations

import importlib.resources
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from typing import Any

import yaml

import pdoik
from bench.common.arrays import FloatArray

Triple = tuple[float, float, float]
Sphere = tuple[str, Triple, float]
Spheroid = tuple[str, Triple, str, Triple, float]
Capsule = tuple[str, Triple, Triple, float, float]  # radius, overhang


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSpec:
    """What a robot is, in numbers and text that JSON keeps exactly.

    Of `name`, `urdf` and `rows` one is given: a built-in robot, a description, or a DH table.
    """

    name: str = ""
    urdf: str = ""
    rows: list[dict[str, Any]] = field(default_factory=list)  # arguments of pdoik.DhRow
    base_link: str = ""  # "" for the root of the description
    tip_links: list[str] = field(default_factory=list)
    T_world_base: list[list[float]] | None = None
    floating_base: list[list[float]] | None = None  # lower and upper of x y z yaw pitch roll
    spheres: list[Sphere] = field(default_factory=list)
    spheroids: list[Spheroid] = field(default_factory=list)
    capsules: list[Capsule] = field(default_factory=list)
    ignored_pairs: list[tuple[str, str]] = field(default_factory=list)

    @classmethod
    def of_json(cls, values: dict[str, Any]) -> RobotSpec:
        """From what `asdict` gave and JSON kept, which turns tuples into lists."""
        spheres = [(link, tuple(xyz), radius) for link, xyz, radius in values["spheres"]]
        spheroids = [(a, tuple(p), b, tuple(q), A) for a, p, b, q, A in values["spheroids"]]
        pairs = [tuple(pair) for pair in values["ignored_pairs"]]
        capsules = [
            (link, tuple(p), tuple(q), r, *(overhang or [0.0]))
            for link, p, q, r, *overhang in values.get("capsules", [])
        ]
        hulls = {"spheres": spheres, "spheroids": spheroids, "capsules": capsules}
        rest = {**hulls, "ignored_pairs": pairs}
        return cls(**{**values, **rest})

    def to_json(self) -> dict[str, Any]:
        """See `of_json`."""
        return asdict(self)

    def description(self) -> str:
        """The URDF's text; "" of a DH table."""
        return builtin_text(self.name, "urdf") if self.name else self.urdf

    def make(self) -> pdoik.Robot:
        """The library's robot."""
        if self.rows:
            robot = pdoik.Robot.from_dh([pdoik.DhRow(**row) for row in self.rows])
        else:
            where: dict[str, Any] = {"base_link": self.base_link or None}
            where["tip_link"] = self.tip_links
            if self.floating_base is not None:
                where["floating_base"] = (self.floating_base[0], self.floating_base[1])
            if self.T_world_base is not None:
                where["T_world_base"] = self.T_world_base
            if self.name:
                robot = pdoik.Robot.builtin(self.name, **where)
            else:
                robot = pdoik.Robot.from_urdf(self.urdf, **where)
        robot.occupancy = pdoik.Occupancy(
            spheres=self.spheres, spheroids=self.spheroids, capsules=self.capsules
        )
        robot.ignored_pairs = self.ignored_pairs
        return robot


@cache
def builtin_text(name: str, ending: str) -> str:
    """A file of a built-in robot: urdf, srdf or occupancy.yaml."""
    return (importlib.resources.files("pdoik") / "robots" / f"{name}.{ending}").read_text()


@cache
def builtin_spec(name: str) -> RobotSpec:
    """A built-in robot with its hulls and ignored pairs, read from its files."""
    hulls = yaml.safe_load(builtin_text(name, "occupancy.yaml"))
    pairs = ElementTree.fromstring(builtin_text(name, "srdf")).iterfind("disable_collisions")
    return RobotSpec(
        name=name,
        tip_links=BUILTIN_TIPS[name],
        spheres=[
            (s["link"], tuple(map(float, s["center"])), float(s["radius"]))
            for s in hulls.get("spheres", [])
        ],
        spheroids=[
            (
                *(s["link_a"], tuple(map(float, s["focus_a"]))),
                *(s["link_b"], tuple(map(float, s["focus_b"]))),
                float(s["semi_major"]),
            )
            for s in hulls.get("spheroids", [])
        ],
        capsules=[
            (
                *(c["link"], tuple(map(float, c["a"])), tuple(map(float, c["b"]))),
                *(float(c["radius"]), float(c.get("overhang", 0.0))),
            )
            for c in hulls.get("capsules", [])
        ],
        ignored_pairs=[(pair.attrib["link1"], pair.attrib["link2"]) for pair in pairs],
    )


BUILTIN_TIPS = {
    "panda": ["panda_link8"],
    "ur10": ["tool0"],
    "iiwa14": ["iiwa_link_ee"],
    "h1": ["left_ankle_link", "right_ankle_link", "left_elbow_link", "right_elbow_link"],
}


def numbers(values: Sequence[float] | FloatArray) -> str:
    """As URDF has them, every digit kept."""
    return " ".join(repr(float(value)) for value in values)
