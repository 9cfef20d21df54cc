"""Robots by their description alone: of it the library makes its robot and the judge its own."""

import importlib.resources
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Self
from xml.etree import ElementTree

import yaml

import pdoik

Triple = tuple[float, float, float]
Sphere = tuple[str, Triple, float]
Spheroid = tuple[str, Triple, str, Triple, float]
Capsule = tuple[str, Triple, Triple, float, float]  # radius, overhang

BUILTIN_TIPS = {
    "panda": ["panda_link8"],
    "ur10": ["tool0"],
    "iiwa14": ["iiwa_link_ee"],
    "h1": ["left_ankle_link", "right_ankle_link", "left_elbow_link", "right_elbow_link"],
}


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
    def of_json(cls, values: dict[str, Any]) -> Self:
        """Make it of what `asdict` gave and JSON kept, which turns tuples into lists."""
        names = ("spheres", "spheroids", "capsules", "ignored_pairs")
        rows = {name: [_tuples(row) for row in values.get(name, [])] for name in names}
        rows["capsules"] = [(*row, 0.0)[:5] for row in rows["capsules"]]  # old ones: no overhang
        return cls(**{**values, **rows})

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
                where["floating_base"] = tuple(self.floating_base)
            if self.T_world_base is not None:
                where["T_world_base"] = self.T_world_base
            make = pdoik.Robot.builtin if self.name else pdoik.Robot.from_urdf
            robot = make(self.name or self.urdf, **where)
        robot.occupancy = pdoik.Occupancy(
            spheres=self.spheres, spheroids=self.spheroids, capsules=self.capsules
        )
        robot.ignored_pairs = self.ignored_pairs
        return robot


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


@cache
def builtin_text(name: str, ending: str) -> str:
    """A file of a built-in robot: urdf, srdf or occupancy.yaml."""
    return (importlib.resources.files("pdoik") / "robots" / f"{name}.{ending}").read_text()


@cache
def builtin_spec(name: str) -> RobotSpec:
    """A built-in robot with its hulls and ignored pairs, read from its files."""
    hulls = yaml.safe_load(builtin_text(name, "occupancy.yaml"))
    pairs = ElementTree.fromstring(builtin_text(name, "srdf")).iterfind("disable_collisions")

    def plain(value: Any) -> Any:
        if isinstance(value, list):
            return tuple(map(float, value))
        return value if isinstance(value, str) else float(value)

    def rows(kind: str, *names: str) -> list[Any]:
        return [tuple(plain(each.get(n, 0.0)) for n in names) for each in hulls.get(kind, [])]

    return RobotSpec(
        name=name,
        tip_links=BUILTIN_TIPS[name],
        spheres=rows("spheres", "link", "center", "radius"),
        spheroids=rows("spheroids", "link_a", "focus_a", "link_b", "focus_b", "semi_major"),
        capsules=rows("capsules", "link", "a", "b", "radius", "overhang"),
        ignored_pairs=[(pair.attrib["link1"], pair.attrib["link2"]) for pair in pairs],
    )


def numbers(values: Sequence[float]) -> str:
    """As URDF has them, every digit kept."""
    return " ".join(repr(float(value)) for value in values)
