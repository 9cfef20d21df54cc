"""EBIKE's scenes: the tool comes along the inward normal of a surface and touches it."""

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.problems.families.family import Draft, Placement, family, legs
from bench.ik.problems.problem import Contact
from bench.ik.problems.solids import Solid, box, cylinder, pose

TOUCH = ("wrist_3_link", "ee_link", "tool0")  # UR10's tool, which may touch what carries a target
UR10 = {"ur10": Placement()}
UP = np.array([0, 0, 1.0])
TOP = 0.7417  # of the table [m]
WIDE, DEEP, BOARD = 0.335, 0.38, 0.02  # of a shelf's cell, and a board's thickness [m]
FRONT, SHELF_FLOOR = 0.6, 0.1  # of the shelf from the robot's axis along y; its lowest board [m]
PITCH = WIDE + BOARD
APOTHEM, HEIGHT, WALL = 0.1444, 0.35, 0.02  # of the barrel's inner hexagon [m]
CENTER = np.array([0.0, 0.5, 0.0])
FLOOR = 0.0276  # of the barrel [m]


def facing(point: FloatArray, normal: FloatArray) -> FloatArray:
    """A tool's pose at a point, its z against the outward normal, (4, 4).

    Its x axis is the base's x (or y, where the normal is along x), made level with the surface.
    """
    z = -normal / np.linalg.norm(normal)
    along = np.array([1.0, 0, 0]) if abs(z[0]) < 0.9 else np.array([0, 1.0, 0])
    x = along - (along @ z) * z
    x /= np.linalg.norm(x)
    return pose(point, np.column_stack([x, np.cross(z, x), z]))


def _allow(solid: str) -> frozenset[Contact]:
    return frozenset((link, solid) for link in TOUCH)


@family("table_top", "on a table's top", UR10, contact=True)
def table_top(rng: np.random.Generator, _: Placement) -> Draft:
    """Anywhere on a table of 1 m by 1 m, 0.74 m high, half a metre next to the robot."""
    high = TOP - 0.04
    solids = [box("top", (1.0, 1.0, 0.04), pose((0, 0.97, TOP - 0.02)))]
    solids += legs((0.06, 0.06, high), (-0.45, 0.45), (0.52, 1.42), high / 2)
    point = np.array([rng.uniform(-0.5, 0.5), rng.uniform(0.47, 1.47), TOP])
    return Draft(solids, facing(point, UP), _allow("top"))


@family("cubby_shelf", "in a shelf of four cells", UR10, contact=True)
def cubby_shelf(rng: np.random.Generator, _: Placement) -> Draft:
    """A cell's board, from above, or its back, from the front."""
    column, row = rng.integers(2, size=2)
    x = (column - 0.5) * PITCH + rng.uniform(-0.4, 0.4) * WIDE
    floor = SHELF_FLOOR + row * PITCH
    if rng.random() < 0.5:
        point = np.array([x, FRONT + rng.uniform(0.05, 0.95) * DEEP, floor])
        return Draft(_shelf(), facing(point, UP), _allow(f"board_{row}"))
    point = np.array([x, FRONT + DEEP, floor + rng.uniform(0.1, 0.9) * WIDE])
    return Draft(_shelf(), facing(point, np.array([0, -1.0, 0])), _allow("back"))


def _shelf() -> list[Solid]:
    """Three boards, three uprights, and a back wall."""
    middle, width = FRONT + DEEP / 2, 2 * PITCH + BOARD
    heights = [SHELF_FLOOR - BOARD / 2 + k * PITCH for k in range(3)]
    z = SHELF_FLOOR + PITCH - BOARD / 2
    return [
        *(
            box(f"board_{k}", (width, DEEP, BOARD), pose((0, middle, at)))
            for k, at in enumerate(heights)
        ),
        *(
            box(f"upright_{k}", (BOARD, DEEP, 2 * PITCH), pose((x, middle, z)))
            for k, x in enumerate((-PITCH, 0, PITCH))
        ),
        box("back", (width, 0.01, 2 * PITCH), pose((0, FRONT + DEEP + 0.005, z))),
    ]


@family("barrel", "on the inside of a barrel", UR10, contact=True, version=2)
def barrel(rng: np.random.Generator, _: Placement) -> Draft:
    """The bottom (one in five) or one of six walls, from within."""
    if rng.random() < 0.2:
        around, out = rng.uniform(0, 2 * np.pi), APOTHEM * np.sqrt(rng.random())
        point = CENTER + np.array([out * np.cos(around), out * np.sin(around), FLOOR])
        return Draft(_barrel(), facing(point, UP), _allow("bottom"))
    k, half = int(rng.integers(6)), APOTHEM / np.sqrt(3)
    R = _turn(k)
    local = [APOTHEM, rng.uniform(-half, half), rng.uniform(FLOOR, HEIGHT)]
    return Draft(_barrel(), facing(CENTER + R @ local, -R[:, 0]), _allow(f"wall_{k}"))


def _barrel() -> list[Solid]:
    size = (WALL, 2 * (APOTHEM + WALL) / np.sqrt(3), HEIGHT)
    out = [APOTHEM + WALL / 2, 0, HEIGHT / 2]
    return [
        cylinder("bottom", APOTHEM, FLOOR, pose((*CENTER[:2], FLOOR / 2))),
        *(box(f"wall_{k}", size, pose(CENTER + _turn(k) @ out, _turn(k))) for k in range(6)),
    ]


def _turn(k: int) -> FloatArray:
    return np.asarray(Rotation.from_euler("z", k * np.pi / 3).as_matrix())
