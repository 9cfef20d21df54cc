"""Hills of ever more triangles below and next to an arm: taken in, and solved among."""

import time
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.judges.triangles import tree_of
from bench.ik.large.arms import (
    TOUCHES,
    fastest,
    free_configurations,
    jobs_of,
    placed_capsules,
)
from bench.ik.large.boxes import clear_boxes
from bench.ik.lines import Line
from bench.ik.safety.world import ARMS, to_solid
from bench.ik.soak.solves import Row

SIZES = (6, 20)
COUNTS = (1_000, 100_000, 1_000_000)  # triangles
WIDE, DEEP, CLEAR = 3.0, 0.2, 0.02  # [m]
FEW = 10  # boxes that it is compared with


jobs = partial(jobs_of, COUNTS)


def hills(rng: np.random.Generator, triangles: int) -> tuple[FloatArray, Any]:
    """A closed slab with a hilly upper side, lower around the base: vertices, faces."""
    n = int(np.sqrt(triangles / 4.0)) + 1
    x, y = np.meshgrid(*2 * [np.linspace(-WIDE / 2, WIDE / 2, n)], indexing="ij")
    height = np.zeros_like(x)
    for _ in range(40):
        at, size = rng.uniform(-WIDE / 2, WIDE / 2, 2), rng.uniform(0.05, 0.25)
        height += rng.uniform(0.0, 0.35) * np.exp(-((x - at[0]) ** 2 + (y - at[1]) ** 2) / size**2)
    height *= np.clip((np.hypot(x, y) - 0.25) / 0.3, 0.0, 1.0)
    top = np.stack([x, y, height - 0.08], axis=-1).reshape(-1, 3)
    bottom = np.stack([x, y, np.full_like(x, -0.08 - DEEP)], axis=-1).reshape(-1, 3)
    number = np.arange(n * n).reshape(n, n)
    a, b, c, d = (number[i : n - 1 + i, j : n - 1 + j].ravel() for i in (0, 1) for j in (0, 1))
    up = np.concatenate([np.stack([a, c, d], 1), np.stack([a, d, b], 1)])
    rim = np.concatenate([number[:, 0], number[-1, 1:], number[-2::-1, -1], number[0, -2:0:-1]])
    on = np.roll(rim, -1)
    below = n * n
    side = np.concatenate(
        [np.stack([rim + below, on + below, on], 1), np.stack([rim + below, on, rim], 1)]
    )
    faces = np.concatenate([up, up[:, ::-1] + below, side])
    return np.concatenate([top, bottom]), faces


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One arm among hills of so many triangles."""
    robot = pdoik.Robot.builtin(job["arm"])
    rng = np.random.default_rng([job["seed"], ARMS.index(job["arm"])])
    vertices, faces = hills(rng, job["count"])
    allowed = [(robot.link_names[0], "hills")]
    mesh = pdoik.Shape.mesh("hills", vertices, faces)
    began = time.perf_counter()
    scene = pdoik.Scene([mesh], allowed=allowed)
    intake = time.perf_counter() - began
    solver = pdoik.Solver(robot, pdoik.Options(base_collision=False))
    near = pdoik.Solver(robot, pdoik.Options(base_collision=False, report_clearance=0.05))
    ground = tree_of(vertices, faces)
    free: list[FloatArray] = []
    while len(free) < job["cases"]:
        free += [
            q
            for q in free_configurations(robot, rng, job["cases"])
            if solver.judge(robot.fk(q), q, obstacles=scene).clearance > CLEAR
        ]
    free = free[: job["cases"]]
    few = pdoik.Scene(clear_boxes(robot, rng, FEW, free))
    rows: list[Row] = []
    for k, q in enumerate(free):
        start, T = free[k - 1], robot.fk(q)
        took, result = fastest(lambda T=T, start=start: solver.solve(T, start, scene))
        bounded, _ = fastest(lambda T=T, start=start: near.solve(T, start, scene))
        among_few, _ = fastest(lambda T=T, start=start: solver.solve(T, start, few))
        apart = np.inf
        if result.success:  # its base may stand in the ground
            placed = placed_capsules(job["arm"], result.q, standing=False)
            apart = float(to_solid(*placed, ground, np.eye(4))[0].min())
        rows.append(
            {
                **job,
                "triangles": len(faces),
                "intake": intake,
                "took": took,
                "few": among_few,
                "bounded": bounded,
                "solved": result.success,
                "wrong": apart < -TOUCHES,
            }
        )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines by number of triangles."""
    found = []
    for count, some in trials.groupby("count"):
        found.append(
            Line(
                what=f"hills of {int(some.triangles.iloc[0]):,} triangles: intake; solve over one "
                "among ten boxes, and with report_clearance=0.05; solved",
                asked={100_000: "0.3 s; 3 times", 1_000_000: "3 s; 3 times"}.get(int(count), ""),
                measured=f"{duration(some.intake.median())}; {duration(some.took.median())} (95 %: "
                f"{duration(some.took.quantile(0.95))}), "
                f"{some.took.median() / some.few.median():.2f} times, "
                f"{some.bounded.median() / some.few.median():.2f} times; {some.solved.mean():.3f}",
                cases=f"{len(some):,}",
                failures=int(some.wrong.sum()),
            )
        )
    return found
