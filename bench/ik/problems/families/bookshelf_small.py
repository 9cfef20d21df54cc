"""One shelf compartment, 1.2 m deep, 1 m wide and 0.3 m high, three cans in it."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import (
    Draft,
    Family,
    Placement,
    Range,
    near,
    panda,
    vary,
    world,
)
from bench.ik.problems.solids import Solid, box, cylinder, pose

CANS = ("can_1", "can_2", "can_3")


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    cans = [
        cylinder(name, 0.03, 0.14, pose((x, 0, 1.08)))
        for name, x in zip(CANS, (0.9, 0.7, 0.5), strict=True)
    ]
    return [
        *cans,
        box("shelf_bottom", (1.2, 1, 0.04), pose((1, 0, 1))),
        box("shelf_top", (1.2, 1, 0.04), pose((1, 0, 1.3))),
        box("side_left", (1.2, 0.04, 0.34), pose((1, -0.5, 1.15))),
        box("side_right", (1.2, 0.04, 0.34), pose((1, 0.5, 1.15))),
    ]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """Cans anywhere across the shelf; the query is 0.2 m before one of them."""
    T = world(placement.base, Range(position=(0.1, 0.1, 0.4), yaw=1.57), rng)
    solids = [s.moved(T) for s in vary(nominal(), CANS, Range(position=(0, 0.45, 0)), rng)]
    can = solids[int(rng.integers(len(CANS)))]
    grasp = near(can, (-0.2, 0, 0.05)) @ placement.T_query_grasp
    return Draft(solids=tuple(solids), grasp=grasp)


FAMILY = Family(
    name="bookshelf_small",
    about="a deep shelf compartment",
    robots={"panda": panda((0.2, 0, -0.7)), "ur5": Placement(base=(0, 0, -0.75))},
    draw=draw,
)
