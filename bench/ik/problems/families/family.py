"""What a family is, and the variations that its scenes have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from bench.ik.problems.problem import Contact
from bench.ik.problems.solids import Solid, pose

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A scene and a target, of which nobody knows yet whether it can be met."""

    solids: tuple[Solid, ...]
    grasp: FloatArray | None  # T_base_grasp of the robot's grasp link, (4, 4); None for fk(random)
    allowed: frozenset[Contact] = frozenset()
    posture: Callable[[np.random.Generator, Sequence[str]], FloatArray] | None = None
    """Draws the configuration where there is no grasp, for joints of these names; None: uniform."""
    contacts: Mapping[str, FloatArray] = field(default_factory=dict)  # as Problem has them


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Where a robot stands in a family's scenes, and how it takes hold."""

    base: tuple[float, float, float] = (0.0, 0.0, 0.0)  # added to everything in the scene [m]
    T_query_grasp: FloatArray = field(default_factory=lambda: np.eye(4))
    """The robot's grasp link where the query's x axis points at the object."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Scenes of one kind."""

    name: str
    about: str
    robots: Mapping[str, Placement]
    draw: Callable[[np.random.Generator, Placement], Draft]
    contact: bool = False  # the tool touches what carries the target; targets may be unreachable
    version: int = 1  # counts up when the same seed gives other problems


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """A uniform variation: position [m] and roll, pitch, yaw [rad], each within plus or minus."""

    position: tuple[float, float, float]
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
            solid = Solid(solid.name, solid.kind, solid.size, T, solid.vertices, solid.faces)
        varied.append(solid)
    return varied


def world(base: tuple[float, float, float], within: Range, rng: np.random.Generator) -> FloatArray:
    """Takes a nominal scene to the robot's base: the offset, then the variation of all at once."""
    return within.draw(rng) @ pose(base)


def quaternion(x: float, y: float, z: float, w: float) -> FloatArray:
    """The rotation matrix of a quaternion."""
    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())


DOWN = quaternion(0, 0.707107, 0, 0.707107)
"""A query whose x axis, along which one takes hold, points down."""
SIDEWAYS = quaternion(0.271, 0.653, 0.271, 0.653)
"""Panda's flange in a query: its z along the query's x, the fingers level where that is."""
UPRIGHT = quaternion(0.653, 0.271, 0.653, 0.271)
"""The same turned by a right angle about z, for queries that point down."""


def panda(base: tuple[float, float, float], turn: FloatArray = SIDEWAYS) -> Placement:
    """Panda with its flange 0.08 m ahead of the query: the fingers reach what is 0.2 m ahead."""
    return Placement(base=base, T_query_grasp=pose((0.08, 0, 0), turn))


def near(
    solid: Solid, offset: tuple[float, float, float], rotation: FloatArray | None = None
) -> FloatArray:
    """A query's pose, in the solid's frame turned to where its scene points: (4, 4)."""
    return solid.T @ pose(offset, rotation)
