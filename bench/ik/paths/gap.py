"""Straight ways where there is little room: between two cubes, and through a gap in a wall."""

from collections.abc import Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from bench.common.arrays import FloatArray
from bench.ik.lines import Line, jobs_of
from bench.ik.paths.arms import ARMS, PLACES
from bench.ik.paths.placing import facing, placed, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import run_or_refer, solved, stepped, timed, worst
from bench.ik.paths.solids import Solid, World, box, frame
from bench.ik.soak.solves import Row

SIZES = (1, 15)  # of each kind, arm and goal
KINDS = ("cubes", "wall")
ASKED = (0.060, 0.300)  # as of a free axis among obstacles [s]
TABLE = -0.03  # [m]
WALLS = {  # how far they are from the base [m]
    "panda": (0.42, 0.6),
    "ur10": (0.6, 0.9),
    "iiwa14": (0.6, 0.75),
    "torso": (0.42, 0.6),
}


jobs = partial(jobs_of, arm=ARMS)


def draw(arm: str, kind: str, goal: str, index: int, seed: int) -> Problem:
    """One problem; the goal is `pose` or `axis`."""
    numbers = ARMS.index(arm), KINDS.index(kind), ("pose", "axis").index(goal)
    rng = np.random.default_rng([seed, 3, *numbers, index])
    count = int(rng.choice([100, 200, 200, 300]))

    def anywhere() -> Problem:
        T, solids = (_between_cubes if kind == "cubes" else _through_wall)(rng, arm, count)
        return Problem(
            key=f"gap:{arm}:{kind}:{goal}:{index}:{seed}",
            arm=arm,
            T=T,
            tool=tool(rng),
            free=goal == "axis",
            world=World(solids=[Solid(kind="half_space", T=frame([0, 0, TABLE])), *solids]),
        )

    return placed(anywhere, rng)


def _between_cubes(
    rng: np.random.Generator, arm: str, count: int
) -> tuple[FloatArray, list[Solid]]:
    """In at one end of the slot and out at the other, the tool down, below the cubes' tops."""
    place = PLACES[arm]
    bearing, radius = rng.uniform(-1.0, 1.0), rng.uniform(*place.radius)
    edge, room = rng.uniform(0.15, 0.3), rng.uniform(0.16, 0.3)
    turn = bearing + rng.uniform(-np.pi, np.pi)
    R = Rotation.from_euler("z", turn).as_matrix()
    centre = np.array([radius * np.cos(bearing), radius * np.sin(bearing), TABLE + 0.5 * edge])
    side = 0.5 * (edge + room) * R[:, 1]
    cubes = [box([edge] * 3, centre + side, R), box([edge] * 3, centre - side, R)]
    height = TABLE + edge - rng.uniform(0.0, 0.7) * (edge - 0.03)
    half = 0.5 * edge + rng.uniform(0.0, 0.05)
    start = np.array([*centre[:2], height])
    P = start + np.linspace(-half, half, count)[:, None] * R[:, 0]
    return _straight(P, facing(rng, bearing, 0.0)), cubes


def _through_wall(rng: np.random.Generator, arm: str, count: int) -> tuple[FloatArray, list[Solid]]:
    """A path from before a wall through a window in it, the tool ahead, and the wall's solids."""
    bearing, distance = rng.uniform(-1.0, 1.0), rng.uniform(*WALLS[arm])
    height, thick = rng.uniform(0.35, 0.65), rng.uniform(0.02, 0.06)
    wide, high = rng.uniform(0.22, 0.4, 2)
    R = Rotation.from_euler("z", bearing).as_matrix()
    centre = np.array([distance * np.cos(bearing), distance * np.sin(bearing), height])
    boards = [
        ([thick, 0.4, 1.4], [0.0, 0.2 + 0.5 * wide, 0.0]),
        ([thick, 0.4, 1.4], [0.0, -0.2 - 0.5 * wide, 0.0]),
        ([thick, wide, 0.6], [0.0, 0.0, 0.3 + 0.5 * high]),
        ([thick, wide, 0.3], [0.0, 0.0, -0.15 - 0.5 * high]),
    ]
    solids = [box(size, centre + R @ at, R) for size, at in boards]
    aside = R @ [0.0, *rng.uniform(-0.25, 0.25, 2) * [wide, high]]
    way = np.linspace(-rng.uniform(0.02, 0.1), rng.uniform(0.05, 0.22), count)
    P = centre + aside + way[:, None] * R[:, 0]
    return _straight(P, facing(rng, bearing, np.pi / 2)), solids


def _straight(P: FloatArray, R: FloatArray) -> FloatArray:
    T = np.tile(np.eye(4), (len(P), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, P
    return T


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One of each kind and goal."""
    rows: list[Row] = []
    for kind, goal in product(KINDS, ("pose", "axis")):
        problem = draw(job["arm"], kind, goal, job["index"], job["seed"])
        if not rows:
            problem.ask()  # what is made once
        rows.append(run_or_refer(problem, job["seed"]) | {"kind": kind, "goal": goal})
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of each kind."""
    found = []
    for kind, some in trials.groupby("kind", sort=False):
        what = {"cubes": "between two cubes", "wall": "through a gap in a wall"}[str(kind)]
        found += [solved(some, what), timed(some, what, ASKED)]
    return [*found, stepped(trials, "both"), worst(trials, "both")]
