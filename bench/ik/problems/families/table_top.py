"""EBIKE's table: 1 m by 1 m, 0.74 m high, half a metre beside a UR10; the tool touches its top."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import Draft, Family, Placement
from bench.ik.problems.families.on_surface import allow, facing
from bench.ik.problems.solids import box, pose

TOP = 0.7417  # [m]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """A point anywhere on the top."""
    solids = (
        box("top", (1.0, 1.0, 0.04), pose((0, 0.97, TOP - 0.02))),
        *(
            box(f"leg_{k}", (0.06, 0.06, TOP - 0.04), pose((x, y, (TOP - 0.04) / 2)))
            for k, (x, y) in enumerate((x, y) for x in (-0.45, 0.45) for y in (0.52, 1.42))
        ),
    )
    point = np.array([rng.uniform(-0.5, 0.5), rng.uniform(0.47, 1.47), TOP])
    grasp = facing(point, np.array([0, 0, 1.0]))
    return Draft(solids=solids, grasp=grasp, allowed=allow("top"))


FAMILY = Family(
    name="table_top",
    about="on a table's top",
    robots={"ur10": Placement()},
    draw=draw,
    contact=True,
)
