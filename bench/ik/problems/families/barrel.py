"""EBIKE's barrel: six walls, 0.29 m across, 0.35 m high; the tool touches them from within."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from bench.ik.problems.families.family import Draft, Family, Placement
from bench.ik.problems.families.on_surface import allow, facing
from bench.ik.problems.solids import Solid, box, cylinder, pose

APOTHEM, HEIGHT, WALL = 0.1444, 0.35, 0.02  # of the inner hexagon [m]
CENTER = np.array([0.0, 0.5, 0.0])
FLOOR = 0.0276  # [m]


def barrel() -> list[Solid]:
    """The bottom and six walls."""
    edge = 2 * (APOTHEM + WALL) / np.sqrt(3)
    walls = []
    for k in range(6):
        R = Rotation.from_euler("z", k * np.pi / 3).as_matrix()
        at = CENTER + R @ [APOTHEM + WALL / 2, 0, HEIGHT / 2]
        walls.append(box(f"wall_{k}", (WALL, edge, HEIGHT), pose(at, R)))
    bottom = cylinder("bottom", APOTHEM, FLOOR, pose((*CENTER[:2], FLOOR / 2)))
    return [bottom, *walls]


def draw(rng: np.random.Generator, placement: Placement) -> Draft:
    """A point of the bottom (one in five) or of a wall's inner side."""
    if rng.random() < 0.2:
        around, out = rng.uniform(0, 2 * np.pi), APOTHEM * np.sqrt(rng.random())
        point = CENTER + np.array([out * np.cos(around), out * np.sin(around), FLOOR])
        return Draft(
            solids=tuple(barrel()),
            grasp=facing(point, np.array([0, 0, 1.0])),
            allowed=allow("bottom"),
        )
    k = int(rng.integers(6))
    R = Rotation.from_euler("z", k * np.pi / 3).as_matrix()
    half = APOTHEM / np.sqrt(3)
    local = [APOTHEM, rng.uniform(-half, half), rng.uniform(FLOOR, HEIGHT)]
    grasp = facing(CENTER + R @ local, -R[:, 0])
    return Draft(solids=tuple(barrel()), grasp=grasp, allowed=allow(f"wall_{k}"))


FAMILY = Family(
    name="barrel",
    about="on the inside of a barrel",
    robots={"ur10": Placement()},
    draw=draw,
    contact=True,
    version=2,
)
