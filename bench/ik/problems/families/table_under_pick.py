"""The same table: the target is under its top (in the published sets the pose one starts from)."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import Draft, Family, Placement, near, panda
from bench.ik.problems.families.table_pick import scene


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """The query is 0.3 m under the table's top, 0.5 m before its middle."""
    solids = scene(rng, placement)
    top = next(solid for solid in solids if solid.name == "table_top")
    return Draft(solids=tuple(solids), grasp=near(top, (-0.5, 0, -0.3)) @ placement.T_query_grasp)


FAMILY = Family(
    name="table_under_pick",
    about="under a table's top",
    robots={"panda": panda((0.1, 0.1, -0.5)), "ur5": Placement(base=(0, 0, -0.45))},
    draw=draw,
)
