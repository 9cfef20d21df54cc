"""cuRobo's table: a slab of 5 m by 5 m under the robot, the pose of a random configuration."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import Draft, Family, Placement
from bench.ik.problems.solids import box, pose


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """The robot's foot stands on the table, so these two may touch."""
    table = box("table", (5.0, 5.0, 0.2), pose((0, 0, -0.1)))
    allowed = frozenset({("panda_link0", "table"), ("base_link", "table")})
    return Draft(solids=(table,), grasp=None, allowed=allowed)


FAMILY = Family(
    name="flat_table",
    about="above a table that the robot stands on",
    robots={"panda": Placement(), "ur5": Placement(), "ur10": Placement()},
    draw=draw,
)
