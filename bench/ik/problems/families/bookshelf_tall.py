"""Three shelf compartments one above the other, 1.2 m deep and 1 m wide, three cans in each."""

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

ROWS = (0.78, 1.08, 1.38)  # heights of the cans' middles [m]
CANS = tuple(f"can_{k}" for k in range(1, 10))


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    places = [(x, 0, z) for z in ROWS for x in (0.9, 0.7, 0.5)]
    cans = [cylinder(name, 0.03, 0.14, pose(at)) for name, at in zip(CANS, places, strict=True)]
    boards = [
        box(f"shelf_{k}", (1.2, 1, 0.04), pose((1, 0, z)))
        for k, z in enumerate((0.7, 1.0, 1.3, 1.6))
    ]
    sides = [
        box(name, (1.3, 0.04, 1.64), pose((1, y, 0.82)))
        for name, y in (("side_left", -0.5), ("side_right", 0.5))
    ]
    return [*cans, *boards, *sides]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """Cans anywhere across the shelves; the query is 0.2 m before one of them."""
    T = world(placement.base, Range(position=(0.1, 0.1, 0), yaw=1.57), rng)
    solids = [s.moved(T) for s in vary(nominal(), CANS, Range(position=(0, 0.45, 0)), rng)]
    can = solids[int(rng.integers(len(CANS)))]
    grasp = near(can, (-0.2, 0, 0.05)) @ placement.T_query_grasp
    return Draft(solids=tuple(solids), grasp=grasp)


FAMILY = Family(
    name="bookshelf_tall",
    about="three deep shelf compartments",
    robots={"panda": panda((0.3, 0, -0.7)), "ur5": Placement(base=(0.1, 0.1, -0.9144))},
    draw=draw,
)
