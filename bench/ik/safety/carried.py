"""A box in the hand among balls that move, at random budgets: is anything deeper after a step?"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.lines import Jobs, Line
from bench.ik.safety.world import ARMS, KEPT, PERIOD, ROUNDING, Box, box_gap, judge_of, robot_of
from bench.ik.soak.hulls import capsules
from bench.ik.soak.judge import Judge, random_configurations
from bench.ik.soak.solves import Row

SIZES = (3, 12)  # runs
STEPS = 250  # of a run
BUDGETS = (2e-5, 1e-3)  # drawn between; one in four has none [s]


def jobs(size: int, seed: int) -> Jobs:
    """The arms by turns."""
    return {
        f"{ARMS[k % 3]}-{k:04d}": {"robot": ARMS[k % 3], "seed": seed, "index": k}
        for k in range(size)
    }


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One run."""
    name = job["robot"]
    judge, robot = judge_of(name), robot_of(name)
    rng = np.random.default_rng([job["seed"], 11, job["index"]])
    box = _in_hand(rng)
    start = _start(judge, box, rng)
    budget = 0.5 if rng.random() < 0.25 else float(10 ** rng.uniform(*np.log10(BUDGETS)))
    balls = _balls(judge, start, rng)
    tracker = pdoik.Tracker(pdoik.Solver(robot), period=PERIOD, max_time=budget)
    tracker.reset(start)
    tracker.attach(judge.kinematics.spec.tip_links[0], [box.shape("box")])
    goal_at = judge.kinematics.into_limits(start + rng.normal(size=(1, len(start))) * 0.7)
    T = np.eye(4)
    R, p = judge.kinematics.link(
        judge.kinematics.place(goal_at), judge.kinematics.spec.tip_links[0]
    )
    T[:3, :3], T[:3, 3] = R[0], p[0]
    Q, struck = [tracker.q.copy()], 0
    for those in balls:
        step = tracker.step(T, those)
        struck += step.tracking == "deadline_struck"
        Q.append(step.q.copy())
    beyond = deeper(judge, box, np.array(Q), balls)
    return [
        {
            "robot": name,
            "index": job["index"],
            "budget": budget,
            "n": len(balls),
            "struck": struck,
            "moved": int((np.diff(Q, axis=0) != 0.0).any(axis=1).sum()),
            "deeper": int((beyond > ROUNDING).sum()),
            "first": int(np.argmax(beyond > ROUNDING)),
            "worst": float(beyond.max()),
        }
    ]


def deeper(judge: Judge, box: Box, Q: FloatArray, balls: FloatArray) -> FloatArray:
    """Depth of each step in balls (T, N, 4), or itself, beyond that of Q[k] and contact [m]."""
    now, held = (_gaps(judge, box, some, balls) for some in (Q[1:], Q[:-1]))
    beyond: FloatArray = np.max(
        [np.minimum(still, 0.0) - there for there, still in zip(now, held, strict=True)], axis=0
    )
    return beyond


def _gaps(
    judge: Judge, box: Box, Q: FloatArray, balls: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """To balls, and of the robot with what it holds to itself, (T,) each."""
    placed = judge.kinematics.place(Q)
    a, b = judge.hulls(placed)
    to_balls = judge.clearance(a, b, balls, KEPT)
    R, p = judge.kinematics.link(placed, judge.kinematics.spec.tip_links[0])
    R_box, p_box = R @ box.T[:3, :3], p + R @ box.T[:3, 3]
    local = np.einsum("tij,tni->tnj", R_box, balls[..., :3] - p_box[:, None])
    off = np.abs(local) - box.size / 2
    outside = np.linalg.norm(np.maximum(off, 0.0), axis=-1)
    gap = outside + np.minimum(off.max(axis=-1), 0.0) - balls[..., 3]
    own = judge.self_distance(a, b)
    ends_p, ends_q, radii = capsules(a, b, judge.A, judge.swept)
    others = _others(judge)
    for k in range(len(Q)):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R_box[k], p_box[k]
        there = Box(size=box.size, T=T)
        gap_k = box_gap(ends_p[k, others], ends_q[k, others], radii[k, others], there)
        own[k] = min(own[k], gap_k)
    return np.minimum(to_balls, gap.min(axis=1)), own


def _others(judge: Judge) -> BoolArray:
    """Hulls that do not move with the hand."""
    hand = judge.kinematics.seat(judge.kinematics.spec.tip_links[0])[0]
    return np.array([judge.kinematics.seat(link)[0] != hand for link, _ in judge.links])


def _in_hand(rng: np.random.Generator) -> Box:
    T = np.eye(4)
    size = rng.uniform(0.03, 0.2, 3)
    T[:3, 3] = [*rng.uniform(-0.03, 0.03, 2), 0.16 + size[2] / 2]
    return Box(size=size, T=T)


def _start(judge: Judge, box: Box, rng: np.random.Generator) -> FloatArray:
    """A random configuration that is off itself, with the box."""
    far = np.array([[[9.0, 9.0, 9.0, 0.1]]])
    while True:
        q = random_configurations(judge.kinematics, 1, rng)
        if _gaps(judge, box, q, far)[1][0] > 0.005:
            return np.asarray(q[0])


def _balls(judge: Judge, q: FloatArray, rng: np.random.Generator) -> FloatArray:
    """That come by, (T, N, 4)."""
    count = int(rng.integers(1, 10))
    middle = judge.kinematics.place(q[None]).p[0]
    at = middle[rng.integers(2, len(middle), size=count)] + rng.normal(size=(count, 3)) * 0.3
    speed = rng.normal(size=(count, 3)) * rng.choice([0.0, 3e-4, 1e-3])
    track = at + np.arange(STEPS)[:, None, None] * speed
    radii = np.broadcast_to(rng.uniform(0.0, 0.08, (count, 1)), (STEPS, count, 1))
    return np.concatenate([track, radii], axis=-1)


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of all runs."""
    steps, deep = int(trials.n.sum()), int(trials.deeper.sum())
    return [
        Line(
            what="the same with a box in the hand of three arms, 1 to 9 balls that move",
            asked="0",
            measured=f"{deep} of {steps:,}, at most {max(0.0, trials.worst.max()):.1g} m",
            cases=f"{steps:,} steps, {int(trials.struck.sum()):,} struck",
            failures=deep,
        )
    ]
