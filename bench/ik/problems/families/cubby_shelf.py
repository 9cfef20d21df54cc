"""A shelf of two by two cells 0.33 m wide and 0.38 m deep; the tool touches boards and backs."""

from __future__ import annotations

import numpy as np

from bench.ik.problems.families.family import Draft, Family, Placement
from bench.ik.problems.families.on_surface import allow, facing
from bench.ik.problems.solids import Solid, box, pose

WIDE, DEEP, BOARD = 0.335, 0.38, 0.02  # of a cell, and a board's thickness [m]
FRONT = 0.6  # of the shelf, from the robot's axis along y [m]
FLOOR = 0.1  # height of the lowest board's top [m]


def shelf() -> list[Solid]:
    """Three boards, three uprights, and a back wall."""
    middle = FRONT + DEEP / 2
    pitch = WIDE + BOARD
    boards = [
        box(f"board_{k}", (2 * pitch + BOARD, DEEP, BOARD), pose((0, middle, z)))
        for k, z in enumerate(FLOOR - BOARD / 2 + k * pitch for k in range(3))
    ]
    z = FLOOR + pitch - BOARD / 2
    uprights = [
        box(f"upright_{k}", (BOARD, DEEP, 2 * pitch), pose((x, middle, z)))
        for k, x in enumerate((-pitch, 0, pitch))
    ]
    back = box("back", (2 * pitch + BOARD, 0.01, 2 * pitch), pose((0, FRONT + DEEP + 0.005, z)))
    return [*boards, *uprights, back]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """A point of a cell's board, from above, or of its back, from the front."""
    pitch = WIDE + BOARD
    column, row = rng.integers(2, size=2)
    x = (column - 0.5) * pitch + rng.uniform(-0.4, 0.4) * WIDE
    floor = FLOOR + row * pitch
    if rng.random() < 0.5:
        point = np.array([x, FRONT + rng.uniform(0.05, 0.95) * DEEP, floor])
        grasp, carrier = facing(point, np.array([0, 0, 1.0])), f"board_{row}"
    else:
        point = np.array([x, FRONT + DEEP, floor + rng.uniform(0.1, 0.9) * WIDE])
        grasp, carrier = facing(point, np.array([0, -1.0, 0])), "back"
    return Draft(solids=tuple(shelf()), grasp=grasp, allowed=allow(carrier))


FAMILY = Family(
    name="cubby_shelf",
    about="in a shelf of four cells",
    robots={"ur10": Placement()},
    draw=draw,
    contact=True,
)
