"""MotionBenchMaker's scenes: shapes, sizes, variations and queries are the published ones.

Scenes are built with their front towards x = 0; what varies all at once brings them to the robot's
base. The query's x axis is the one along which one takes hold.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.problems.families.family import Draft, Placement, Range, Triple, family, legs, vary
from bench.ik.problems.solids import Solid, box, cylinder, pose


def _quaternion(x: float, y: float, z: float, w: float) -> FloatArray:
    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())


DOWN = _quaternion(0, 0.707107, 0, 0.707107)  # a query that points down
SIDEWAYS = _quaternion(0.271, 0.653, 0.271, 0.653)
"""Panda's flange in a query: its z along the query's x, the fingers level where that is."""
UPRIGHT = _quaternion(0.653, 0.271, 0.653, 0.271)
"""The same turned by a right angle about z, for queries that point down."""


def _panda(base: Triple, turn: FloatArray = SIDEWAYS) -> Placement:
    """Panda with its flange 0.08 m ahead of the query: the fingers reach what is 0.2 m ahead."""
    return Placement(base, pose((0.08, 0, 0), turn))


def _boxes(**sizes_and_places: tuple[Triple, Triple]) -> list[Solid]:
    return [box(name, size, pose(at)) for name, (size, at) in sizes_and_places.items()]


def _cans(places: Sequence[Triple]) -> list[Solid]:
    return [cylinder(f"can_{k}", 0.03, 0.14, pose(at)) for k, at in enumerate(places, start=1)]


def _world(placement: Placement, within: Range, rng: np.random.Generator) -> FloatArray:
    """Takes a scene to the robot's base: the offset, then the variation of all at once."""
    return within.draw(rng) @ pose(placement.base)


def _before_a_can(
    rng: np.random.Generator,
    placement: Placement,
    cans: list[Solid],
    shelf: list[Solid],
    moved: Triple,
    across: float,
) -> Draft:
    """Cans shifted across their shelves; the query is 0.2 m before one of them."""
    T = _world(placement, Range(moved, yaw=1.57), rng)
    names = [can.name for can in cans]
    solids = [s.moved(T) for s in vary([*cans, *shelf], names, Range((0, across, 0)), rng)]
    query = solids[int(rng.integers(len(cans)))].T @ pose((-0.2, 0, 0.05))
    return Draft(solids, query @ placement.T_query_grasp)


@family(
    "bookshelf_small",
    "a deep shelf compartment",
    {"panda": _panda((0.2, 0, -0.7)), "ur5": Placement((0, 0, -0.75))},
)
def bookshelf_small(rng: np.random.Generator, placement: Placement) -> Draft:
    """One compartment, 1.2 m deep, 1 m wide and 0.3 m high, three cans in it."""
    shelf = _boxes(
        shelf_bottom=((1.2, 1, 0.04), (1, 0, 1)),
        shelf_top=((1.2, 1, 0.04), (1, 0, 1.3)),
        side_left=((1.2, 0.04, 0.34), (1, -0.5, 1.15)),
        side_right=((1.2, 0.04, 0.34), (1, 0.5, 1.15)),
    )
    cans = _cans([(x, 0, 1.08) for x in (0.9, 0.7, 0.5)])
    return _before_a_can(rng, placement, cans, shelf, (0.1, 0.1, 0.4), across=0.45)


@family(
    "bookshelf_tall",
    "three deep shelf compartments",
    {"panda": _panda((0.3, 0, -0.7)), "ur5": Placement((0.1, 0.1, -0.9144))},
)
def bookshelf_tall(rng: np.random.Generator, placement: Placement) -> Draft:
    """Three compartments one above the other, 1.2 m deep and 1 m wide, three cans in each."""
    shelf = _boxes(
        **{f"shelf_{k}": ((1.2, 1, 0.04), (1, 0, z)) for k, z in enumerate((0.7, 1.0, 1.3, 1.6))},
        side_left=((1.3, 0.04, 1.64), (1, -0.5, 0.82)),
        side_right=((1.3, 0.04, 1.64), (1, 0.5, 0.82)),
    )
    cans = _cans([(x, 0, z) for z in (0.78, 1.08, 1.38) for x in (0.9, 0.7, 0.5)])
    return _before_a_can(rng, placement, cans, shelf, (0.1, 0.1, 0), across=0.45)


@family(
    "bookshelf_thin",
    "a rack with ten cells",
    {"panda": _panda((-0.1, 0, -0.7)), "ur5": Placement((0, 0, -0.9144))},
)
def bookshelf_thin(rng: np.random.Generator, placement: Placement) -> Draft:
    """Six boards on four legs, an upright in the middle, cells 0.5 m wide and 0.25 m high."""
    heights = (0.35, 0.6, 0.85, 1.1, 1.35, 1.6)
    shelf = _boxes(
        **{f"shelf_{k}": ((0.62, 1, 0.04), (1, 0, z)) for k, z in enumerate(heights)},
        upright=((0.62, 0.04, 1.4), (1, 0, 0.9)),
    )
    shelf += legs((0.04, 0.04, 1.64), (0.7, 1.3), (-0.5, 0.5), 0.82)
    levels = enumerate((0.44, 0.69, 0.94, 1.19, 1.44))
    cans = _cans([(x, -0.25 if k % 2 else 0.25, z) for k, z in levels for x in (1.1, 0.8)])
    return _before_a_can(rng, placement, cans, shelf, (0.1, 0.1, 0), across=0.2)


@family(
    "box",
    "into an open box from above",
    {
        "panda": _panda((-0.15, 0, -1.02), UPRIGHT),
        "ur5": Placement((0, 0, -1.1), pose((-0.035, 0.045, 0))),
    },
)
def open_box(rng: np.random.Generator, placement: Placement) -> Draft:
    """A box 0.7 m wide with a tilted lid; the query points down at a can anywhere across it."""
    T = _world(placement, Range((0.1, 0.1, 0.1), yaw=1.57), rng)
    solids = [
        cylinder("can", 0.03, 0.14, pose((0.8, 0, 0.55))),
        *_boxes(
            bottom=((0.7, 0.7, 0.04), (0.8, 0, 0.44)),
            side_left=((0.7, 0.04, 0.7), (0.8, -0.35, 0.8)),
            side_right=((0.7, 0.04, 0.7), (0.8, 0.35, 0.8)),
            front=((0.04, 0.7, 0.6), (0.45, 0, 0.7)),
        ),
        box("lid", (0.7, 0.7, 0.04), pose((0.9, 0, 1.35), _quaternion(0, 0.383, 0, 0.924))),
        box("back", (0.04, 0.7, 0.7), pose((1.15, 0, 0.8))),
    ]
    solids = [s.moved(T) for s in vary(solids, ("can",), Range((0, 0.2, 0)), rng)]
    height = (0.25, 0.5)[int(rng.integers(2))]  # above the can's middle: in the box, at its rim
    return Draft(solids, solids[0].T @ pose((0, 0, height), DOWN) @ placement.T_query_grasp)


@family(
    "cage",
    "into a cage between two bars",
    {  # Panda's flange before the cube and level with it, the fingers about it
        "panda": Placement(
            (0, 0, -0.18), pose((0.184, 0, -0.11), _quaternion(0, 0, -0.924, 0.383))
        ),
        "ur5": Placement((0, 0, -0.8), pose((-0.035, 0.045, 0))),
    },
)
def cage(rng: np.random.Generator, placement: Placement) -> Draft:
    """A cage 0.7 m wide, closed but for the gaps between two bars in front, a cube in it."""
    T = _world(placement, Range((0.1, 0.1, 0.1), yaw=0.5), rng)
    solids = _boxes(
        cube=((0.07, 0.07, 0.07), (0.8, 0, 0.52)),
        bottom=((0.7, 0.7, 0.04), (0.8, 0, 0.44)),
        side_left=((0.7, 0.04, 0.7), (0.8, -0.35, 0.8)),
        side_right=((0.7, 0.04, 0.7), (0.8, 0.35, 0.8)),
        bar_upper=((0.04, 0.7, 0.04), (0.45, 0, 0.9)),
        bar_lower=((0.04, 0.7, 0.04), (0.45, 0, 0.6)),
        cap=((0.65, 0.65, 0.04), (0.85, 0, 1.15)),
        back=((0.04, 0.7, 0.7), (1.15, 0, 0.8)),
    )
    solids = [solid.moved(T) for solid in solids]
    query = solids[0].T @ pose((0, 0, 0.21), DOWN) @ pose((*rng.uniform(-0.05, 0.05, 2), 0))
    return Draft(solids, query @ placement.T_query_grasp)


def _table(rng: np.random.Generator, placement: Placement) -> list[Solid]:
    """A table 1.2 m deep and 2 m wide with upright things around a can, which is the first."""
    things = ("cube", "object_1", "object_2", "object_3", "object_4", "object_5")
    solids = [
        cylinder("can", 0.03, 0.12, pose((0.85, 0, 0.8))),
        box("table_top", (1.2, 2, 0.04), pose((1.05, 0, 0.7))),
        *legs((0.05, 0.05, 0.7), (0.6, 1.5), (-0.85, 0.85), 0.35),
        box("cube", (0.25, 0.25, 0.25), pose((0.75, 0.4, 0.85))),
        cylinder("object_1", 0.05, 0.35, pose((1.35, 0, 0.85))),
        *_boxes(
            object_2=((0.2, 0.02, 0.4), (1.05, -0.2, 0.9)),
            object_3=((0.02, 0.2, 0.4), (0.65, 0.2, 0.9)),
            object_4=((0.2, 0.05, 0.35), (0.65, -0.2, 0.9)),
            object_5=((0.2, 0.05, 0.35), (1.05, 0.2, 0.9)),
        ),
    ]
    solids = vary(solids, ("can",), Range((0.05, 0.05, 0)), rng)
    solids = vary(solids, things, Range((0.1, 0.1, 0), yaw=1.57), rng)
    T = _world(placement, Range((0.1, 0.1, 0.1), yaw=1.57), rng)
    return [solid.moved(T) for solid in solids]


@family(
    "table_pick",
    "to a can among upright things on a table",
    {"panda": _panda((0.1, 0.1, -0.5)), "ur5": Placement((0, 0, -0.75))},
)
def table_pick(rng: np.random.Generator, placement: Placement) -> Draft:
    """The query is 0.2 m before the can."""
    solids = _table(rng, placement)
    return Draft(solids, solids[0].T @ pose((-0.2, 0, 0.025)) @ placement.T_query_grasp)


@family(
    "table_under_pick",
    "under a table's top",
    {"panda": _panda((0.1, 0.1, -0.5)), "ur5": Placement((0, 0, -0.45))},
)
def table_under_pick(rng: np.random.Generator, placement: Placement) -> Draft:
    """The query is 0.3 m under the top, 0.5 m before its middle; published ones start there."""
    solids = _table(rng, placement)
    return Draft(solids, solids[1].T @ pose((-0.5, 0, -0.3)) @ placement.T_query_grasp)
