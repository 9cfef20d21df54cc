"""What is in an arm's way: solids and points, as the library takes them and by definition."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

import pdoik
from bench.common.arrays import FloatArray

Vector = Sequence[float] | FloatArray
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
SECTIONS = 60  # golden ones of a capsule's axis: 0.618^60 is 3e-13 of its length


@dataclass(frozen=True, slots=True, kw_only=True)
class Solid:
    """A box by its edges, a cylinder about z by radius and length, or all below its z = 0."""

    kind: Literal["box", "cylinder", "half_space"]
    size: tuple[float, ...] = ()  # [m]
    T: FloatArray = field(default_factory=lambda: np.eye(4))  # in the base frame, (4, 4)

    def shape(self, name: str) -> pdoik.Shape:
        """The library's."""
        if self.kind == "box":
            return pdoik.Shape.box(name, self.size, self.T)
        if self.kind == "cylinder":
            radius, length = self.size
            return pdoik.Shape.cylinder(name, radius, length, self.T)
        return pdoik.Shape.half_space(name, self.T[:3, 2], self.T[:3, 3])

    def distance(self, points: FloatArray) -> FloatArray:
        """Distance of points (..., 3) to its surface, negative inside, (...) [m]."""
        local = (points - self.T[:3, 3]) @ self.T[:3, :3]
        if self.kind == "half_space":
            return np.asarray(local[..., 2])
        if self.kind == "box":
            off = np.abs(local) - 0.5 * np.asarray(self.size)
        else:
            radius, length = self.size
            beyond = np.hypot(local[..., 0], local[..., 1]) - radius
            off = np.stack([beyond, np.abs(local[..., 2]) - 0.5 * length], axis=-1)
        outside = np.linalg.norm(np.maximum(off, 0.0), axis=-1)
        return np.asarray(outside + np.minimum(off.max(axis=-1), 0.0))

    def to_segment(self, p: FloatArray, q: FloatArray) -> FloatArray:
        """Distance of the segments pq, (K, 3) each, (K,) [m].

        The distance from a convex solid is a convex function along a line: golden sections.
        """
        low, high = np.zeros(len(p)), np.ones(len(p))

        def at(share: FloatArray) -> FloatArray:
            return self.distance(p + share[:, None] * (q - p))

        for _ in range(SECTIONS):
            one, other = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            nearer = at(one) < at(other)
            low, high = np.where(nearer, low, one), np.where(nearer, other, high)
        ends = np.minimum(self.distance(p), self.distance(q))
        return np.minimum(ends, at(0.5 * (low + high)))

    def sample(self, spacing: float, rng: np.random.Generator) -> FloatArray:
        """Points of its surface, about one of each square of that edge, (N, 3) [m]."""
        half = 0.5 * np.asarray(self.size)
        if self.kind == "box":
            areas = np.array([half[k - 2] * half[k - 1] for k in range(3)]) * 8.0
            count = rng.poisson(areas.sum() / spacing**2)
            local = rng.uniform(-half, half, (count, 3))
            side = rng.choice(3, count, p=areas / areas.sum())
            local[np.arange(count), side] = half[side] * rng.choice([-1.0, 1.0], count)
        else:
            radius, length = self.size
            count = rng.poisson(2 * np.pi * radius * (length + radius) / spacing**2)
            turn = rng.uniform(0, 2 * np.pi, count)
            on_side = rng.random(count) < length / (length + radius)
            out = np.where(on_side, radius, radius * np.sqrt(rng.random(count)))
            up = np.where(on_side, rng.uniform(-1, 1, count), rng.choice([-1.0, 1.0], count))
            local = np.stack([out * np.cos(turn), out * np.sin(turn), 0.5 * length * up], axis=1)
        return np.asarray(local @ self.T[:3, :3].T + self.T[:3, 3])


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """Solids and points, (N, 3) [m]."""

    solids: Sequence[Solid] = ()
    points: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    def given(self) -> pdoik.Scene | list[pdoik.Shape] | FloatArray | None:
        """As the library takes them."""
        shapes = [solid.shape(f"{solid.kind}{k}") for k, solid in enumerate(self.solids)]
        if shapes and len(self.points):
            return pdoik.Scene(shapes, cloud=self.points)
        return shapes or (self.points if len(self.points) else None)

    def as_points(self, spacing: float, rng: np.random.Generator) -> "World":
        """The same with points of the solids' surfaces instead of all that are bounded."""
        flat = [solid for solid in self.solids if solid.kind == "half_space"]
        rest = [solid for solid in self.solids if solid.kind != "half_space"]
        points = [solid.sample(spacing, rng) for solid in rest]
        return World(solids=flat, points=np.concatenate([self.points, *points]))


def box(size: Vector, at: Vector, R: FloatArray | None = None) -> Solid:
    """One somewhere."""
    return Solid(kind="box", size=tuple(map(float, size)), T=frame(at, R))


def cylinder(radius: float, length: float, at: Vector, R: FloatArray | None = None) -> Solid:
    """One somewhere."""
    return Solid(kind="cylinder", size=(float(radius), float(length)), T=frame(at, R))


def frame(at: Vector, R: FloatArray | None = None) -> FloatArray:
    """A transform (4, 4)."""
    T = np.eye(4)
    T[:3, 3] = at
    if R is not None:
        T[:3, :3] = R
    return T
