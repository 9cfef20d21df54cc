"""A table 1.2 m deep and 2 m wide with upright things around a can."""

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

CLUTTER = ("cube", "object_1", "object_2", "object_3", "object_4", "object_5")


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    legs = [
        box(f"leg_{k}", (0.05, 0.05, 0.7), pose((x, y, 0.35)))
        for k, (x, y) in enumerate((x, y) for x in (0.6, 1.5) for y in (-0.85, 0.85))
    ]
    return [
        cylinder("can", 0.03, 0.12, pose((0.85, 0, 0.8))),
        box("table_top", (1.2, 2, 0.04), pose((1.05, 0, 0.7))),
        *legs,
        box("cube", (0.25, 0.25, 0.25), pose((0.75, 0.4, 0.85))),
        cylinder("object_1", 0.05, 0.35, pose((1.35, 0, 0.85))),
        box("object_2", (0.2, 0.02, 0.4), pose((1.05, -0.2, 0.9))),
        box("object_3", (0.02, 0.2, 0.4), pose((0.65, 0.2, 0.9))),
        box("object_4", (0.2, 0.05, 0.35), pose((0.65, -0.2, 0.9))),
        box("object_5", (0.2, 0.05, 0.35), pose((1.05, 0.2, 0.9))),
    ]


def scene(rng: np.random.Generator, placement: Placement) -> list[Solid]:
    """The table with everything on it moved about; the can is the first."""
    solids = vary(nominal(), ("can",), Range(position=(0.05, 0.05, 0)), rng)
    solids = vary(solids, CLUTTER, Range(position=(0.1, 0.1, 0), yaw=1.57), rng)
    T = world(placement.base, Range(position=(0.1, 0.1, 0.1), yaw=1.57), rng)
    return [solid.moved(T) for solid in solids]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """The query is 0.2 m before the can."""
    solids = scene(rng, placement)
    grasp = near(solids[0], (-0.2, 0, 0.025)) @ placement.T_query_grasp
    return Draft(solids=tuple(solids), grasp=grasp)


FAMILY = Family(
    name="table_pick",
    about="to a can among upright things on a table",
    robots={"panda": panda((0.1, 0.1, -0.5)), "ur5": Placement(base=(0, 0, -0.75))},
    draw=draw,
)
