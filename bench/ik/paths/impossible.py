"""Paths that no motion follows: never called whole, and where they break is said.

`reach` leaves the workspace, `wall` goes through one, `jump` and `inside` go through the arm's own
column, `wound` turns the tool farther than joints do (of arms with seven joints only that is not
proved, but three turns in place are more than their wrists have).
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from bench.common.intervals import duration
from bench.ik.lines import Line, jobs_of, share
from bench.ik.paths.arms import ARMS, PLACES
from bench.ik.paths.placing import facing, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.runs import row_of
from bench.ik.paths.sampling import search
from bench.ik.paths.solids import Solid, World, box
from bench.ik.soak.solves import Row

SIZES = (1, 10)  # of each kind and arm
KINDS = ("reach", "wall", "jump", "inside", "wound")
SURELY = {"panda": 1.2, "ur10": 1.6, "iiwa14": 1.2, "torso": 1.2}  # out of reach, from the axis [m]
TURNS = {"ur10": 2.2}  # of the tool in place; of the others three
SEARCH = 2.0  # how far a motion may get [s]
BEFORE = 3  # stations before that, at which an end is still at the place


jobs = partial(jobs_of, arm=ARMS)


def draw(arm: str, kind: str, index: int, seed: int) -> tuple[Problem, float]:
    """One problem, and the station beyond which no motion gets, from the first on."""
    rng = np.random.default_rng([seed, 4, ARMS.index(arm), KINDS.index(kind), index])
    place, count = PLACES[arm], int(rng.choice([100, 200, 200, 300]))
    bearing, height = rng.uniform(-1.2, 1.2), rng.uniform(*place.height)
    forward, up = np.array([np.cos(bearing), np.sin(bearing), 0.0]), np.array([0.0, 0.0, 1.0])
    aside = np.cross(up, forward)
    near = forward * rng.uniform(*place.radius) + up * height
    R = np.tile(facing(rng, bearing, rng.uniform(0.0, 0.8)), (count, 1, 1))
    solids: list[Solid] = []
    if kind == "reach":
        P = near + np.linspace(0.0, 1.6 * SURELY[arm], count)[:, None] * forward
        beyond = float(np.flatnonzero(np.linalg.norm(P[:, :2], axis=1) > SURELY[arm])[0])
    elif kind == "wall":
        half, thick = rng.uniform(0.15, 0.3), 0.16
        P = near + np.linspace(-half, half, count)[:, None] * aside
        turn = Rotation.from_euler("z", bearing).as_matrix()
        solids = [box([1.6, thick, 3.0], forward * (near @ forward - 0.2 + 0.8) + up, turn)]
        beyond = 0.5 * count
    elif kind == "inside":
        half = float(np.linalg.norm(near[:2]))
        P = 0.02 * forward + up * 0.1 + np.linspace(-half, half, count)[:, None] * aside
        R[:] = facing(rng, bearing, 0.0)
        beyond = 0.5 * count
    elif kind == "jump":
        P = near + np.linspace(-0.1, 0.1, count)[:, None] * aside
        P[:, 2] = min(height, 0.3)
        P[count // 2 :, :2] *= -1.0
        beyond = float(count // 2)
    else:
        P = np.tile(near, (count, 1))
        turns = np.linspace(0.0, 2 * np.pi * TURNS.get(arm, 3.0), count)
        spin = Rotation.from_rotvec(turns[:, None] * [0.0, 0.0, 1.0]).as_matrix()
        R, beyond = R @ spin, float(count - 1)
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, P
    return Problem(
        key=f"impossible:{arm}:{kind}:{index}:{seed}",
        arm=arm,
        T=T,
        tool=np.eye(4) if kind == "wall" else tool(rng),
        world=World(solids=solids),
    ), beyond


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One of each kind."""
    rows = []
    for kind in KINDS:
        problem, beyond = draw(job["arm"], kind, job["index"], job["seed"])
        path = problem.ask()
        reached = search(problem, SEARCH, np.random.default_rng([job["seed"], 98])).farthest
        places = np.array([end.at for end in path.ends])
        at_it = (places >= reached - BEFORE) & (places <= beyond + 1)
        rows.append(
            row_of(problem, path)
            | {
                "kind": kind,
                "reached": reached,
                "beyond": beyond,
                "says_where": bool(len(places)),
                "at_it": bool(at_it.any()),
            }
        )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """How each kind is called."""
    found = []
    for kind, some in trials.groupby("kind", sort=False):
        called = ", ".join(f"{n} {status}" for status, n in some.status.value_counts().items())
        ur10 = some[some.arm == "ur10"]
        found.append(
            Line(
                what=f"{kind}: called whole",
                asked="0; impossible of a UR10, unless several motions meet it",
                measured=f"{int(some.whole.sum())}: {called}; of a UR10 impossible "
                f"{share(ur10.status == 'impossible', len(ur10))}, pieces "
                f"{share(ur10.status == 'pieces', len(ur10))}; where: said "
                f"{share(some.says_where, len(some))}, there {share(some.at_it, len(some))}; "
                f"median {duration(some.time.median())}, most {duration(some.time.max())}",
                cases=f"{len(some):,}",
                failures=int(some.whole.sum()),
            )
        )
    return found
