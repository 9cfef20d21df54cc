"""How far a link's capsules stick out beyond its geometry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .segments import Capsules, free, surface
from .solid import Solid

OVERHANG_POINTS = 20_000  # on all capsules of a link together


class Overhang(NamedTuple):
    """Distance from the outer surface of the capsules' union to the solid."""

    mean: float  # weighted by area [m]
    worst: float  # of the sampled points [m]


def overhang(solid: Solid, capsules: Capsules, points: int = OVERHANG_POINTS) -> Overhang:
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
