"""An open box 0.7 m wide with a tilted lid, a can at its bottom: reach in from above."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import (
    DOWN,
    UPRIGHT,
    Draft,
    Family,
    Placement,
    Range,
    near,
    panda,
    quaternion,
    vary,
    world,
)
from bench.ik.problems.solids import Solid, box, cylinder, pose

HEIGHTS = (0.25, 0.5)  # of the query above the can's middle: in the box, and at its rim [m]


def nominal() -> list[Solid]:
    """The scene before anything is varied, its front towards x = 0."""
    return [
        cylinder("can", 0.03, 0.14, pose((0.8, 0, 0.55))),
        box("bottom", (0.7, 0.7, 0.04), pose((0.8, 0, 0.44))),
        box("side_left", (0.7, 0.04, 0.7), pose((0.8, -0.35, 0.8))),
        box("side_right", (0.7, 0.04, 0.7), pose((0.8, 0.35, 0.8))),
        box("front", (0.04, 0.7, 0.6), pose((0.45, 0, 0.7))),
        box("lid", (0.7, 0.7, 0.04), pose((0.9, 0, 1.35), quaternion(0, 0.383, 0, 0.924))),
        box("back", (0.04, 0.7, 0.7), pose((1.15, 0, 0.8))),
    ]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """The can anywhere across the box; the query points down at it."""
    T = world(placement.base, Range(position=(0.1, 0.1, 0.1), yaw=1.57), rng)
    solids = [s.moved(T) for s in vary(nominal(), ("can",), Range(position=(0, 0.2, 0)), rng)]
    height = HEIGHTS[int(rng.integers(len(HEIGHTS)))]
    grasp = near(solids[0], (0, 0, height), DOWN) @ placement.T_query_grasp
    return Draft(solids=tuple(solids), grasp=grasp)


UR5 = Placement(base=(0, 0, -1.1), T_query_grasp=pose((-0.035, 0.045, 0)))
FAMILY = Family(
    name="box",
    about="into an open box from above",
    robots={"panda": panda((-0.15, 0, -1.02), UPRIGHT), "ur5": UR5},
    draw=draw,
)
