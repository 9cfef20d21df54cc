"""Ever more boxes in one room: a solve, and a step in contact, over those among ten."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.large.arms import (
    TOUCHES,
    fastest,
    free_configurations,
    jobs_of,
    placed_capsules,
)
from bench.ik.lines import Line
from bench.ik.safety.world import ARMS, Box, box_gap
from bench.ik.soak.solves import Row

SIZES = (6, 20)
COUNTS = (10, 100, 1_000, 10_000)
ROOM = np.array([[-2.5, -2.5, -0.6], [2.5, 2.5, 2.0]])  # [m]
CLEAR, NEAR, CONTACT = 0.03, 1.5, 0.002  # [m]
STEPS, STRIDE = 250, 0.001  # [m]
JUDGED = 25  # steps to one that coal looks at


jobs = partial(jobs_of, COUNTS)


def random_boxes(rng: np.random.Generator, count: int) -> list[pdoik.Shape]:
    """Boxes with edges of 2 to 8 cm, anywhere."""
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3] = Rotation.random(count, random_state=int(rng.integers(1 << 30))).as_matrix()
    T[:, :3, 3] = rng.uniform(*ROOM, (count, 3))
    sizes = rng.uniform(0.02, 0.08, (count, 3))
    return [pdoik.Shape.box(f"box {k}", sizes[k], T[k]) for k in range(count)]


def clear_boxes(
    robot: pdoik.Robot, rng: np.random.Generator, count: int, free: list[FloatArray]
) -> list[pdoik.Shape]:
    """Draws so many random boxes that are clear of all configurations."""
    solver, kept = pdoik.Solver(robot), []
    while len(kept) < count:
        more = random_boxes(rng, max(100, count - len(kept)))
        scene = pdoik.Scene(more)
        least = np.min([[c.distance for c in solver.clearances(q, scene)] for q in free], axis=0)
        kept += [box for box, room in zip(more, least, strict=True) if room > CLEAR]
    return [
        pdoik.Shape.box(f"box {k}", box.size, box.T_base_shape)
        for k, box in enumerate(kept[:count])
    ]


def near_boxes(boxes: list[pdoik.Shape]) -> list[Box]:
    """Those that an arm can come near to."""
    every = [Box(size=np.array(box.size), T=np.asarray(box.T_base_shape)) for box in boxes]
    return [box for box in every if np.linalg.norm(box.T[:3, 3]) < NEAR]


def depth(arm: str, q: FloatArray, boxes: list[Box]) -> float:
    """How deep the arm is in the boxes, 0 where it is clear [m]."""
    placed = placed_capsules(arm, q)
    return max(0.0, *(-box_gap(*placed, box) for box in boxes))


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """The solves and the steps of one arm among so many."""
    robot = pdoik.Robot.builtin(job["arm"])
    rng = np.random.default_rng([job["seed"], ARMS.index(job["arm"])])
    free = free_configurations(robot, rng, job["cases"])
    boxes = clear_boxes(robot, rng, job["count"], free)
    began = time.perf_counter()
    scene = pdoik.Scene(boxes)
    intake = time.perf_counter() - began
    solver, near = pdoik.Solver(robot), near_boxes(boxes)
    rows: list[Row] = []
    for k, q in enumerate(free):
        start = free[k - 1]
        took, result = fastest(lambda q=q, start=start: solver.solve(robot.fk(q), start, scene))
        wrong = result.success and depth(job["arm"], result.q, near) > TOUCHES
        steps, deepest = push(job["arm"], q, lambda wall: pdoik.Scene([*boxes, wall]), near, rng)
        wrong = wrong or deepest > TOUCHES
        rows.append(
            {
                **job,
                "intake": intake,
                "took": took,
                "solved": result.success,
                "wrong": wrong,
                "steps": len(steps),
                "step": float(np.median(steps)) if steps else np.nan,
                "slow": float(np.quantile(steps, 0.99)) if steps else np.nan,
            }
        )
    return rows


def push(
    arm: str,
    q: FloatArray,
    scene_with: Callable[[pdoik.Shape], pdoik.Scene],
    near: list[Box],
    rng: np.random.Generator,
) -> tuple[list[float], float]:
    """Into one more box before the tool: times of steps in contact [s], the deepest of some [m].

    Args:
        arm: Which.
        q: Where it begins.
        scene_with: Of the box, the scene that has it besides.
        near: The other boxes.
        rng: Says which way.
    """
    robot = pdoik.Robot.builtin(arm)
    judge = pdoik.Solver(robot)
    tracker = pdoik.Tracker(judge, period=0.002, max_time=0.2)
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    goal = np.array(robot.fk(q))
    wall = np.eye(4)
    wall[:3, 3] = goal[:3, 3] + 0.2 * way
    blocks = Box(size=np.full(3, 0.1), T=wall)
    scene = scene_with(blocks.shape("wall"))
    if judge.judge(goal, q, obstacles=scene).clearance < CONTACT:
        return [], 0.0
    tracker.reset(q)
    took, deepest = [], 0.0
    for k in range(STEPS):
        target = goal.copy()
        target[:3, 3] += min(STRIDE * k, 0.2) * way
        began = time.thread_time()
        step = tracker.step(target, obstacles=scene)
        spent = time.thread_time() - began
        if step.clearance < CONTACT:
            took.append(spent)
        if k % JUDGED == JUDGED - 1:
            deepest = max(deepest, depth(arm, np.asarray(step.q), [*near, blocks]))
    return took, deepest


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines by number of boxes."""
    few = trials[trials["count"] == min(COUNTS)]
    found = []
    for count, some in trials.groupby("count"):
        more = some.took.median() / few.took.median(), some.step.median() / few.step.median()
        found.append(
            Line(
                what=f"{count:,} boxes: solve, contact step; over those among ten; solved",
                asked="3; 3 times",
                measured=f"{duration(some.took.median())} (95 %: "
                f"{duration(some.took.quantile(0.95))}), {duration(some.step.median())} (99 %: "
                f"{duration(some.slow.median())}); {more[0]:.2f}, {more[1]:.2f}; "
                f"{some.solved.mean():.3f}; intake {duration(some.intake.median())}",
                cases=f"{len(some):,} solves, {int(some.steps.sum()):,} steps",
                failures=int(some.wrong.sum()),
            )
        )
    return found
