"""What a family is, and the variations that its scenes have in common."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.problems.problem import Contact
from bench.ik.problems.solids import Solid, box, pose

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Draft:
    """A scene and a target, of which nobody knows yet whether it can be met."""

    solids: Sequence[Solid]
    grasp: FloatArray | None  # T_base_grasp of the robot's grasp link, (4, 4); None for fk(random)
    allowed: frozenset[Contact] = frozenset()
    posture: Callable[[np.random.Generator, Sequence[str]], FloatArray] | None = None
    """Draws the configuration where there is no grasp, for joints of these names; None: uniform."""
    contacts: Mapping[str, FloatArray] = field(default_factory=dict)  # as Problem has them


@dataclass(frozen=True, slots=True)
class Placement:
    """Where a robot stands in a family's scenes, and how it takes hold."""

    base: Triple = (0.0, 0.0, 0.0)  # added to everything in the scene [m]
    T_query_grasp: FloatArray = field(default_factory=lambda: np.eye(4))
    """The robot's grasp link where the query's x axis points at the object."""


Draw = Callable[[np.random.Generator, Placement], Draft]


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Scenes of one kind."""

    name: str
    about: str
    robots: Mapping[str, Placement]
    draw: Draw
    contact: bool = False  # the tool touches what carries the target; targets may be unreachable
    version: int = 1  # counts up when the same seed gives other problems


FAMILIES: dict[str, Family] = {}


def family(
    name: str, about: str, robots: Mapping[str, Placement], **more: object
) -> Callable[[Draw], Draw]:
    """Registers what draws the scenes of a family."""

    def register(draw: Draw) -> Draw:
        FAMILIES[name] = Family(name=name, about=about, robots=robots, draw=draw, **more)
        return draw

    return register


@dataclass(frozen=True, slots=True)
class Range:
    """A uniform variation: position [m] and yaw [rad], each within plus or minus."""

    position: Triple
    yaw: float = 0.0

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """A transform within the range."""
        turn = Rotation.from_euler("z", rng.uniform(-self.yaw, self.yaw)).as_matrix()
        return pose(rng.uniform(-np.array(self.position), self.position), turn)


def vary(
    solids: Sequence[Solid], names: Sequence[str], within: Range, rng: np.random.Generator
) -> list[Solid]:
    """The solids, those named turned about their own middles and shifted along the axes."""
    varied = []
    for solid in solids:
        if solid.name in names:
            change = within.draw(rng)
            T = solid.T.copy()
            T[:3, :3] = change[:3, :3] @ T[:3, :3]
            T[:3, 3] += change[:3, 3]
            solid = replace(solid, T=T)
        varied.append(solid)
    return varied


def legs(size: Triple, xs: Sequence[float], ys: Sequence[float], z: float) -> list[Solid]:
    """Four of them, their middles at the height z [m]."""
    return [box(f"leg_{k}", size, pose((*xy, z))) for k, xy in enumerate(product(xs, ys))]
