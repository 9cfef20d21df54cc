"""Ten boxes as a field of signed distances: a solve, and a step in contact, over the boxes'."""

import math
import time
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.large.arms import TOUCHES, fastest, free_configurations, jobs_of
from bench.ik.large.boxes import CLEAR, depth, near_boxes, push, random_boxes
from bench.ik.lines import Line
from bench.ik.safety.world import ARMS
from bench.ik.soak.solves import Row

SIZES = (6, 20)
COUNTS = (50, 100, 200)  # cells along each axis
LOW, WIDE, FEW = np.array([-1.0, -1.0, -0.6]), 2.0, 10  # of the grid [m]; boxes
MARGIN = 0.3  # [m]


jobs = partial(jobs_of, COUNTS)


def sampled(boxes: list[pdoik.Shape], count: int) -> np.ndarray:
    """Signed distances of the middles of cells, (X, Y, Z) [m]."""
    along = (WIDE / count * (np.arange(count) + 0.5))[:, None] + LOW
    least = np.full((count,) * 3, np.inf, np.float32)
    for box in boxes:
        T = np.linalg.inv(box.T_base_shape).astype(np.float32)
        outside, inside = np.zeros_like(least), np.full_like(least, -np.inf)
        for row, half in zip(T[:3], np.array(box.size, np.float32) / 2, strict=True):
            x, y, z = (along[:, a].astype(np.float32) * row[a] for a in range(3))
            over = np.abs(x[:, None, None] + y[:, None] + (z + row[3])) - half
            outside += np.maximum(over, 0) ** 2
            np.maximum(inside, over, out=inside)
        np.minimum(least, np.sqrt(outside) + np.minimum(inside, 0), out=least)
    return least


def is_within(robot: pdoik.Robot, q: FloatArray) -> bool:
    """Whether the tool, and what it is pushed into, are in the grid."""
    tip = robot.fk(q)[:3, 3]
    return bool(((tip > LOW + MARGIN) & (tip < LOW + WIDE - MARGIN)).all())


def clear_boxes(
    robot: pdoik.Robot, rng: np.random.Generator, free: list[FloatArray], room: float
) -> list[pdoik.Shape]:
    """Random ones in the grid that all configurations are clear of."""
    solver, kept = pdoik.Solver(robot), []
    while len(kept) < FEW:
        for box in random_boxes(rng, 100):
            middle = np.asarray(box.T_base_shape)[:3, 3]
            if ((middle < LOW + 0.1) | (middle > LOW + WIDE - 0.1)).any() or len(kept) == FEW:
                continue
            least = min(solver.clearances(q, [box])[0].distance for q in free)
            if least > room:
                kept.append(pdoik.Shape.box(f"box {len(kept)}", box.size, box.T_base_shape))
    return kept


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """The solves and the steps of one arm in a field of so many cells, and among its boxes."""
    robot = pdoik.Robot.builtin(job["arm"])
    rng = np.random.default_rng([job["seed"], ARMS.index(job["arm"])])
    free: list[FloatArray] = []
    while len(free) < job["cases"]:
        free += [q for q in free_configurations(robot, rng, job["cases"]) if is_within(robot, q)]
    free = free[: job["cases"]]
    cell = WIDE / job["count"]
    off = 0.5 * math.sqrt(3) * cell  # what the interpolation may be off by
    boxes = clear_boxes(robot, rng, free, CLEAR + off)
    values, corner = sampled(boxes, job["count"]), np.eye(4)
    corner[:3, 3] = LOW

    def field(values: np.ndarray) -> pdoik.Scene:
        return pdoik.Scene([pdoik.Shape.distance_field("field", values, cell, corner)])

    began = time.perf_counter()
    scene = field(values)
    intake = time.perf_counter() - began
    few, solver, near = pdoik.Scene(boxes), pdoik.Solver(robot), near_boxes(boxes)
    rows: list[Row] = []
    for k, q in enumerate(free):
        start, T = free[k - 1], robot.fk(q)
        took, result = fastest(lambda T=T, start=start: solver.solve(T, start, scene))
        by_boxes, plain = fastest(lambda T=T, start=start: solver.solve(T, start, few))
        wrong = result.success and depth(job["arm"], result.q, near) > off + TOUCHES
        seed = rng.integers(1 << 30)
        steps, deepest = push(
            job["arm"],
            q,
            lambda wall: field(np.minimum(values, sampled([wall], len(values)))),
            near,
            np.random.default_rng(seed),
        )
        plain_steps, _ = push(
            job["arm"],
            q,
            lambda wall: pdoik.Scene([*boxes, wall]),
            near,
            np.random.default_rng(seed),
        )
        rows.append(
            {
                **job,
                "intake": intake,
                "took": took,
                "boxes": by_boxes,
                "solved": result.success,
                "boxes_solved": plain.success,
                "wrong": wrong or deepest > off + TOUCHES,
                "steps": len(steps),
                "step": float(np.median(steps)) if steps else np.nan,
                "slow": float(np.quantile(steps, 0.99)) if steps else np.nan,
                "boxes_step": float(np.median(plain_steps)) if plain_steps else np.nan,
            }
        )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines by number of cells."""
    return [
        Line(
            what=f"ten boxes as a field of {count}^3 cells: intake; solve, contact step; over "
            "those among the boxes; solved, among the boxes",
            asked="",
            measured=f"{duration(some.intake.median())}; {duration(some.took.median())} (95 %: "
            f"{duration(some.took.quantile(0.95))}), {duration(some.step.median())} (99 %: "
            f"{duration(some.slow.median())}); {some.took.median() / some.boxes.median():.2f}, "
            f"{some.step.median() / some.boxes_step.median():.2f}; {some.solved.mean():.3f}, "
            f"{some.boxes_solved.mean():.3f}",
            cases=f"{len(some):,} solves, {int(some.steps.sum()):,} steps",
            failures=int(some.wrong.sum()),
        )
        for count, some in trials.groupby("count")
    ]
