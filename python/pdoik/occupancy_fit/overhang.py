"""How far a link's capsules stick out beyond its geometry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .hulls import FloatArray
from .segments import Capsules, free, surface
from .solid import Solid

OVERHANG_POINTS = 20_000  # on all capsules of a link together


class Overhang(NamedTuple):
    """Distance from the outer surface of the capsules' union to the solid."""

    mean: float  # weighted by area [m]
    worst: float  # of the sampled points [m]

    def meets(self, aim: Overhang) -> bool:
        return self.mean <= aim.mean and self.worst <= aim.worst

    def __str__(self) -> str:
        return f"{1e3 * self.mean:.2f} mm in the mean and {1e3 * self.worst:.1f} mm at worst"


def each_overhang(solid: Solid, capsules: Capsules, points: int = OVERHANG_POINTS) -> FloatArray:
    """How far each capsule's surface, inside others or not, is from the solid at most, (K,) [m]."""
    on = surface(capsules, max(points // len(capsules.radius), 60))
    outside: FloatArray = solid.outside(on.points.reshape(-1, 3)).reshape(on.at.shape)
    return np.asarray(outside.max(axis=1))


def worst_place(solid: Solid, capsules: Capsules, points: int = OVERHANG_POINTS) -> FloatArray:
    """Where the capsules' union sticks out most, and the surface's nearest point, (2, 3) [m].

    Good to the distance of the points on the capsules.
    """
    on = surface(capsules, max(points // len(capsules.radius), 60))
    outer = on.points[free(capsules, on)]
    place = outer[int(solid.outside(outer).argmax())]
    return np.stack([place, solid.nearest(place)])


def overhang_of(solid: Solid, capsules: Capsules, points: int = OVERHANG_POINTS) -> Overhang:
    """Measured on points spread over the surface of the capsules' union.

    Walls of cavities inside the solid are not part of the outer surface.
    """
    count = max(points // len(capsules.radius), 60)
    on = surface(capsules, count)
    outer = free(capsules, on)
    distance = solid.outside(on.points[outer])
    weight = np.repeat(on.areas, outer.sum(axis=1))
    weight = weight * (distance > 0)
    if not weight.sum():
        return Overhang(0.0, 0.0)
    return Overhang(float(weight @ distance / weight.sum()), float(distance.max()))
