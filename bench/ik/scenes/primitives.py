"""Everyday objects as sums of simple surfaces, and points drawn uniformly from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import trimesh

from bench.common.arrays import FloatArray

SIDES = 48  # of the polygon that stands for a circle in a mesh


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A flat face, center + u a + v b with u, v in [-1, 1], (3,) each [m]."""

    center: FloatArray
    a: FloatArray
    b: FloatArray

    @property
    def area(self) -> float:
        return 4 * float(np.linalg.norm(np.cross(self.a, self.b)))

    def sample(self, n: int, rng: np.random.Generator) -> FloatArray:
        u, v = rng.uniform(-1, 1, (2, n, 1))
        return self.center + u * self.a + v * self.b

    def mesh(self) -> FloatArray:
        center, a, b = self.center, self.a, self.b
        corners = np.array([center - a - b, center + a - b, center + a + b, center - a + b])
        return corners[[[0, 1, 2], [0, 2, 3]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Frustum:
    """The side of a cone cut off square, about z: a cylinder, a cone, a disc or a ring."""

    z: tuple[float, float]  # of its two rims [m]
    radius: tuple[float, float]  # of its two rims [m]

    @property
    def area(self) -> float:
        slant = float(np.hypot(self.z[1] - self.z[0], self.radius[1] - self.radius[0]))
        return float(np.pi) * sum(self.radius) * slant

    def sample(self, n: int, rng: np.random.Generator) -> FloatArray:
        r0, r1 = self.radius
        # The circumference grows linearly from rim to rim: r^2 is uniform, or r is constant.
        r = np.sqrt(rng.uniform(min(r0, r1) ** 2, max(r0, r1) ** 2, n))
        t = rng.uniform(size=n) if r0 == r1 else (r - r0) / (r1 - r0)
        angle = rng.uniform(0, 2 * np.pi, n)
        z = self.z[0] + t * (self.z[1] - self.z[0])
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])

    def mesh(self) -> FloatArray:
        angle = np.linspace(0, 2 * np.pi, SIDES + 1)
        circle = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(SIDES + 1)])
        low, high = (r * circle + [0, 0, z] for r, z in zip(self.radius, self.z, strict=True))
        lower = np.stack([low[:-1], low[1:], high[1:]], axis=1)
        faces = np.concatenate([lower, np.stack([low[:-1], high[1:], high[:-1]], axis=1)])
        edges = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        return faces[np.linalg.norm(edges, axis=1) > 1e-15]  # a rim may be a point


@dataclass(frozen=True, slots=True, kw_only=True)
class Ball:
    """A sphere about the origin."""

    radius: float  # [m]

    @property
    def area(self) -> float:
        return 4 * float(np.pi) * self.radius**2

    def sample(self, n: int, rng: np.random.Generator) -> FloatArray:
        direction = rng.normal(size=(n, 3))
        direction *= self.radius / np.linalg.norm(direction, axis=1, keepdims=True)
        return direction

    def mesh(self) -> FloatArray:
        sphere = trimesh.creation.icosphere(subdivisions=3, radius=self.radius)
        return np.asarray(sphere.triangles, dtype=np.float64)


Patch = Rectangle | Frustum | Ball


def sample_surface(patches: Sequence[Patch], n: int, rng: np.random.Generator) -> FloatArray:
    """`n` points, uniform over the joint area of the patches, (n, 3) [m]."""
    area = np.array([patch.area for patch in patches])
    counts = rng.multinomial(n, area / area.sum())
    return np.concatenate(
        [patch.sample(int(count), rng) for patch, count in zip(patches, counts, strict=True)]
    )


def surface_mesh(patches: Sequence[Patch]) -> FloatArray:
    """Triangles of the patches, round ones by inscribed facets, (T, 3, 3) [m]."""
    return np.concatenate([patch.mesh() for patch in patches])


def box(x: float, y: float, z: float) -> tuple[Patch, ...]:
    """The six faces of a box with these edges [m]."""
    half = np.diag([x, y, z]) / 2
    sides = [(i, side) for i in range(3) for side in (-1, 1)]
    return tuple(Rectangle(side * half[i], half[i - 2], half[i - 1]) for i, side in sides)


def turned(*profile: tuple[float, float]) -> tuple[Patch, ...]:
    """The surface that a line through the points (radius, z) [m] sweeps about z."""
    return tuple(Frustum(z=(z0, z1), radius=(r0, r1)) for (r0, z0), (r1, z1) in pairwise(profile))


def can(radius: float, height: float) -> tuple[Patch, ...]:
    """A closed cylinder."""
    return turned((0, 0), (radius, 0), (radius, height), (0, height))


def bottle(radius: float, body: float, shoulder: float, neck: float) -> tuple[Patch, ...]:
    """A cylinder, a cone above it and a narrow neck, of these heights [m]."""
    top = body + shoulder
    throat = 0.35 * radius
    return turned(
        (0, 0), (radius, 0), (radius, body), (throat, top), (throat, top + neck), (0, top + neck)
    )


EVERYDAY_OBJECTS: Mapping[str, tuple[Patch, ...]] = {
    "cereal box": box(0.19, 0.06, 0.28),
    "sugar box": box(0.09, 0.05, 0.175),
    "book": box(0.15, 0.22, 0.03),
    "brick": box(0.215, 0.1025, 0.065),
    "sponge": box(0.11, 0.08, 0.02),
    "knife": box(0.21, 0.022, 0.018),
    "padlock": box(0.066, 0.066, 0.029),
    "toy block": box(0.06, 0.06, 0.06),
    "soup can": can(0.034, 0.102),
    "coffee can": can(0.051, 0.14),
    "tuna can": can(0.043, 0.034),
    "marker": can(0.01, 0.12),
    "water bottle": bottle(0.035, 0.15, 0.05, 0.03),
    "detergent bottle": bottle(0.045, 0.17, 0.06, 0.03),
    "spray bottle": bottle(0.042, 0.14, 0.08, 0.05),
    "tennis ball": (Ball(radius=0.0335),),
    "small football": (Ball(radius=0.065),),
    "golf ball": (Ball(radius=0.0215),),
    "orange": (Ball(radius=0.037),),
    "plate": turned((0, 0), (0.08, 0), (0.13, 0.025), (0.08, 0.006), (0, 0.006)),
    "bowl": turned((0, 0), (0.04, 0), (0.08, 0.055), (0.035, 0.006), (0, 0.006)),
    "mug": turned((0, 0), (0.042, 0), (0.042, 0.095), (0.038, 0.095), (0.038, 0.006), (0, 0.006)),
    "funnel": turned((0.008, 0), (0.008, 0.04), (0.06, 0.12)),
    "traffic cone": turned((0, 0), (0.1, 0), (0.015, 0.25), (0, 0.25)),
}
