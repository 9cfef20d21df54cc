"""A cage 0.7 m wide, closed but for the gaps between two bars in front, a cube in it."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import (
    DOWN,
    Draft,
    Family,
    Placement,
    Range,
    near,
    quaternion,
    world,
)
from bench.ik.problems.solids import Solid, box, pose


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    return [
        box("cube", (0.07, 0.07, 0.07), pose((0.8, 0, 0.52))),
        box("bottom", (0.7, 0.7, 0.04), pose((0.8, 0, 0.44))),
        box("side_left", (0.7, 0.04, 0.7), pose((0.8, -0.35, 0.8))),
        box("side_right", (0.7, 0.04, 0.7), pose((0.8, 0.35, 0.8))),
        box("bar_upper", (0.04, 0.7, 0.04), pose((0.45, 0, 0.9))),
        box("bar_lower", (0.04, 0.7, 0.04), pose((0.45, 0, 0.6))),
        box("cap", (0.65, 0.65, 0.04), pose((0.85, 0, 1.15))),
        box("back", (0.04, 0.7, 0.7), pose((1.15, 0, 0.8))),
    ]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """The query is above the cube; where the hand is from there is the placement's affair."""
    T = world(placement.base, Range(position=(0.1, 0.1, 0.1), yaw=0.5), rng)
    solids = [solid.moved(T) for solid in nominal()]
    x, y = rng.uniform(-0.05, 0.05, 2)
    query = near(solids[0], (0, 0, 0.21), DOWN) @ pose((x, y, 0))
    return Draft(solids=tuple(solids), grasp=query @ placement.T_query_grasp)


PANDA = pose((0.184, 0, -0.11), quaternion(0, 0, -0.924, 0.383))
"""The flange before the cube and level with it, the fingers about it."""
FAMILY = Family(
    name="cage",
    about="into a cage between two bars",
    robots={
        "panda": Placement(base=(0, 0, -0.18), T_query_grasp=PANDA),
        "ur5": Placement(base=(0, 0, -0.8), T_query_grasp=pose((-0.035, 0.045, 0))),
    },
    draw=draw,
)
