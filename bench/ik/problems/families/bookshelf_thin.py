"""A rack: six boards on four legs, an upright in the middle, cells 0.5 m wide and 0.25 m high."""

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

CANS = tuple(f"can_{k}" for k in range(1, 11))
LEVELS = (0.44, 0.69, 0.94, 1.19, 1.44)  # heights of the cans' middles [m]


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    places = [
        (x, 0.25 if level % 2 == 0 else -0.25, z)
        for level, z in enumerate(LEVELS)
        for x in (1.1, 0.8)
    ]
    cans = [cylinder(name, 0.03, 0.14, pose(at)) for name, at in zip(CANS, places, strict=True)]
    boards = [
        box(f"shelf_{k}", (0.62, 1, 0.04), pose((1, 0, z)))
        for k, z in enumerate((0.35, 0.6, 0.85, 1.1, 1.35, 1.6))
    ]
    legs = [
        box(f"leg_{k}", (0.04, 0.04, 1.64), pose((x, y, 0.82)))
        for k, (x, y) in enumerate((x, y) for x in (0.7, 1.3) for y in (-0.5, 0.5))
    ]
    return [*cans, *boards, box("upright", (0.62, 0.04, 1.4), pose((1, 0, 0.9))), *legs]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """Cans shifted across their cells; the query is 0.2 m before one of them."""
    T = world(placement.base, Range(position=(0.1, 0.1, 0), yaw=1.57), rng)
    solids = [s.moved(T) for s in vary(nominal(), CANS, Range(position=(0, 0.2, 0)), rng)]
    can = solids[int(rng.integers(len(CANS)))]
    grasp = near(can, (-0.2, 0, 0.05)) @ placement.T_query_grasp
    return Draft(solids=tuple(solids), grasp=grasp)


FAMILY = Family(
    name="bookshelf_thin",
    about="a rack with ten cells",
    robots={"panda": panda((-0.1, 0, -0.7)), "ur5": Placement(base=(0, 0, -0.9144))},
    draw=draw,
)
