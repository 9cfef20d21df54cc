"""Scenes of the seven kinds that MotionBenchMaker has, drawn anew, and poses of a hand in them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.paths.solids import Solid, box, cylinder, frame

DOWN = np.diag([1.0, -1.0, -1.0])  # a hand over a table, its x ahead
AHEAD = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])  # a hand into a shelf
BOARD = 0.02  # [m]
FLOOR = -0.05  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """Solids, and where a hand's point has something to do among them, (4, 4) each."""

    solids: list[Solid]
    tasks: list[FloatArray]


def _turned(room: Room, at: FloatArray) -> Room:
    """All of it somewhere else, on the floor."""
    solids = [Solid(kind=s.kind, size=s.size, T=at @ s.T) for s in room.solids]
    floor = Solid(kind="half_space", T=frame([0.0, 0.0, FLOOR]))
    return Room(solids=[*solids, floor], tasks=[at @ T for T in room.tasks])


def _stand(rng: np.random.Generator, ahead: tuple[float, float]) -> FloatArray:
    bearing, distance = rng.uniform(-0.5, 0.5), rng.uniform(*ahead)
    yaw = bearing + rng.uniform(-0.25, 0.25)
    at = [distance * np.cos(bearing), distance * np.sin(bearing), 0.0]
    return frame(at, Rotation.from_euler("z", yaw).as_matrix())


def _bookshelf(rng: np.random.Generator, columns: int, rows: int, wide: float, high: float) -> Room:
    """A bookshelf with its front at x = 0 that opens to -x."""
    deep, low = rng.uniform(0.25, 0.35), rng.uniform(0.0, 0.25)
    total, height = columns * wide, rows * high
    middle = low + 0.5 * height
    solids = [box([BOARD, total, height], [deep, 0.0, middle])]
    solids += [
        box([deep, total + BOARD, BOARD], [0.5 * deep, 0.0, low + k * high])
        for k in range(rows + 1)
    ]
    solids += [
        box([deep, BOARD, height], [0.5 * deep, (k - 0.5 * columns) * wide, middle])
        for k in range(columns + 1)
    ]
    tasks = []
    for row in range(rows):
        for column in range(columns):
            centre = np.array([0.0, (column + 0.5 - 0.5 * columns) * wide, low + row * high])
            in_it = [rng.uniform(0.05, 0.5 * deep), 0.0, rng.uniform(0.35, 0.55) * high]
            task = centre + np.array(in_it)
            task[1] += rng.uniform(-0.25, 0.25) * (wide - 0.15)
            tasks.append(frame(task, AHEAD))
            if rng.random() < 0.5:  # something stands behind
                length = rng.uniform(0.08, 0.5 * high)
                aside = rng.uniform(-0.3, 0.3) * wide
                at = centre + np.array([0.8 * deep, aside, 0.5 * (length + BOARD)])
                solids.append(cylinder(rng.uniform(0.02, 0.035), length, at.tolist()))
    return _turned(Room(solids=solids, tasks=tasks), _stand(rng, (0.45, 0.6)))


def bookshelf_small(rng: np.random.Generator) -> Room:
    """Two or three wide boards over one another."""
    return _bookshelf(
        rng, 1, int(rng.integers(2, 4)), rng.uniform(0.6, 0.8), rng.uniform(0.3, 0.36)
    )


def bookshelf_tall(rng: np.random.Generator) -> Room:
    """High compartments, two side by side."""
    return _bookshelf(
        rng, 2, int(rng.integers(2, 4)), rng.uniform(0.4, 0.5), rng.uniform(0.36, 0.44)
    )


def bookshelf_thin(rng: np.random.Generator) -> Room:
    """Three narrow columns."""
    return _bookshelf(
        rng, 3, int(rng.integers(2, 4)), rng.uniform(0.27, 0.33), rng.uniform(0.3, 0.38)
    )


def open_box(rng: np.random.Generator) -> Room:
    """A box without a lid."""
    wide, long = rng.uniform(0.3, 0.45, 2)
    high, low = rng.uniform(0.18, 0.32), rng.uniform(FLOOR + BOARD, 0.2)
    solids = [box([wide, long, BOARD], [0.0, 0.0, low])]
    for sign in (-1.0, 1.0):
        solids.append(box([BOARD, long, high], [sign * 0.5 * wide, 0.0, low + 0.5 * high]))
        solids.append(box([wide, BOARD, high], [0.0, sign * 0.5 * long, low + 0.5 * high]))
    aside = rng.uniform(-0.5, 0.5, 2) * (np.array([wide, long]) - 0.2)
    inside = frame([*aside, low + rng.uniform(0.04, 0.1)], DOWN @ _spin(rng))
    outside = frame([0.0, rng.choice([-1.0, 1.0]) * (0.5 * long + 0.15), low + 0.1], DOWN)
    return _turned(Room(solids=solids, tasks=[inside, outside]), _stand(rng, (0.45, 0.6)))


def cage(rng: np.random.Generator) -> Room:
    """Bars all round and above, but for the front."""
    half, high, low = rng.uniform(0.2, 0.27), rng.uniform(0.4, 0.55), rng.uniform(0.0, 0.2)
    bar, count = 0.02, int(rng.integers(4, 7))
    spread = np.linspace(-half, half, count)
    solids = [box([2 * half, 2 * half, BOARD], [0.0, 0.0, low])]
    for side in spread:
        solids.append(cylinder(0.5 * bar, high, [half, side, low + 0.5 * high]))
        across = Rotation.from_euler("y", np.pi / 2).as_matrix()
        solids.append(cylinder(0.5 * bar, 2 * half, [0.0, side, low + high], across))
        solids += [
            cylinder(0.5 * bar, high, [side, sign * half, low + 0.5 * high]) for sign in (-1.0, 1.0)
        ]
    inside = [rng.uniform(-0.05, 0.5) * half, rng.uniform(-0.4, 0.4) * half, low + 0.45 * high]
    above = frame([0.0, rng.uniform(-0.5, 0.5) * half, low + high + 0.08], DOWN)
    room = Room(solids=solids, tasks=[frame(inside, AHEAD), above])
    return _turned(room, _stand(rng, (0.55, 0.68)))


def table_pick(rng: np.random.Generator) -> Room:
    """Things close together on a table, and a hand between them."""
    top = rng.uniform(0.1, 0.35)
    solids = [box([0.7, 1.2, BOARD], [0.2, 0.0, top - 0.5 * BOARD])]
    tasks: list[FloatArray] = []
    for _ in range(2):
        at = [rng.uniform(-0.05, 0.25), rng.uniform(-0.4, 0.4), top + rng.uniform(0.05, 0.1)]
        tasks.append(frame(at, DOWN @ _spin(rng)))
    while len(solids) < 9:
        place, size = rng.uniform([-0.1, -0.55], [0.45, 0.55]), rng.uniform(0.04, 0.09)
        high = rng.uniform(0.08, 0.28)
        if min(np.linalg.norm(T[:2, 3] - place) for T in tasks) < 0.09 + 0.5 * size:
            continue
        where = [*place, top + 0.5 * high]
        round_ = rng.random() < 0.5
        solids.append(
            cylinder(0.5 * size, high, where) if round_ else box([size] * 2 + [high], where)
        )
    return _turned(Room(solids=solids, tasks=tasks), _stand(rng, (0.4, 0.5)))


def table_under_pick(rng: np.random.Generator) -> Room:
    """Something to be had under a table; the other hand pose is over it."""
    top, legs = rng.uniform(0.42, 0.6), rng.uniform(0.25, 0.4)
    solids = [box([2 * legs, 1.0, BOARD], [legs, 0.0, top])]
    for x in (0.03, 2 * legs - 0.03):
        solids += [box([0.05, 0.05, top], [x, sign * 0.45, 0.5 * top]) for sign in (-1.0, 1.0)]
    under = [rng.uniform(0.05, 0.2), rng.uniform(-0.25, 0.25), rng.uniform(0.1, top - 0.2)]
    over = [rng.uniform(0.05, 0.2), rng.uniform(-0.3, 0.3), top + rng.uniform(0.08, 0.2)]
    room = Room(solids=solids, tasks=[frame(under, AHEAD), frame(over, DOWN @ _spin(rng))])
    return _turned(room, _stand(rng, (0.4, 0.52)))


def _spin(rng: np.random.Generator) -> FloatArray:
    return np.asarray(Rotation.from_euler("z", rng.uniform(-np.pi, np.pi)).as_matrix())


ROOMS: Mapping[str, Callable[[np.random.Generator], Room]] = {
    "bookshelf small": bookshelf_small,
    "bookshelf tall": bookshelf_tall,
    "bookshelf thin": bookshelf_thin,
    "box": open_box,
    "cage": cage,
    "table pick": table_pick,
    "table under pick": table_under_pick,
}
