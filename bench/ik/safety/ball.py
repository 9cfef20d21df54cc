"""A ball of 8 cm that crosses a Panda's forearm, as a cloud of balls and as one shape."""

import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.judges.distances import to_segment
from bench.ik.lines import Jobs, Line, millimetres
from bench.ik.safety.world import PERIOD, UNHURRIED, judge_of, pose_of, robot_of
from bench.ik.soak.judge import Judge
from bench.ik.soak.solves import Row

POINTS = (116, 800, 10_000)
SPEEDS = (0.3, 0.5)  # [m/s]
RADIUS = 0.08  # [m]
CLEARANCE, TOLERANCE = 0.02, 1e-6  # [m]
WAY = 0.75  # of the ball [m]
POSTURE = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
PREEMPTED = 1e-4  # a step whose thread waits for longer was [s]
LOOK = 0.03  # beyond the clearance no figure is needed [m]
SIZES = (2, 8)  # runs


def jobs(size: int, seed: int) -> Jobs:
    """One for each number of points, 0 for a shape, and speed."""
    pairs = [(points, speed) for points in (116, 0, 800, 10_000) for speed in SPEEDS]
    return {
        f"{points}-{speed:g}": {"points": points, "speed": speed, "seed": seed}
        for points, speed in pairs[:size]
    }


def ball_of(points: int, seed: int) -> FloatArray:
    """Balls on a sphere, about its centre, (points, 4) [m]."""
    at = np.random.default_rng(seed).normal(size=(points, 3))
    at *= RADIUS / np.linalg.norm(at, axis=1, keepdims=True)
    return np.hstack([at, np.full((points, 1), 0.015 if points < 1000 else 0.005)])


def centres(speed: float) -> FloatArray:
    """Centres of the ball at each step, (T, 3) [m]."""
    y = -0.45 + speed * PERIOD * np.arange(round(WAY / speed / PERIOD))
    return np.stack([np.full(len(y), 0.3), y, np.full(len(y), 0.62)], axis=1)


def crossing(
    points: int, speed: float, seed: int, max_time: float | None, *, told: bool = False
) -> tuple[FloatArray, list[pdoik.TrackerResult], FloatArray]:
    """Configurations (T, n), what each step says, and for how long its thread had to wait [s].

    A tracker that is given the ball's speed has it with every step.
    """
    judge, ball = judge_of("panda"), ball_of(points, seed)
    options = pdoik.Options(clearance=CLEARANCE, max_obstacles=20_000)
    tracker = pdoik.Tracker(pdoik.Solver(robot_of("panda"), options), PERIOD, max_time=max_time)
    tracker.reset(POSTURE)
    tracker.set_posture(POSTURE)
    T = pose_of(judge, POSTURE)
    said, absent = [], []
    velocity = np.array([0.0, speed, 0.0]) if told else None
    for at in centres(speed):
        given: Any = ball + np.r_[at, 0.0]
        if points == 0:
            given = [pdoik.Shape.sphere("ball", at, RADIUS)]
        wall, cpu = time.perf_counter(), time.thread_time()
        said.append(tracker.step(T, given, obstacle_velocity=velocity))
        absent.append(time.perf_counter() - wall - (time.thread_time() - cpu))
    return np.array([step.q for step in said]), said, np.array(absent)


def clearances(
    judge: Judge, Q: FloatArray, points: int, speed: float, seed: int, *, later: int = 0
) -> FloatArray:
    """True ones after each step, (T,); infinite where the whole ball is far off [m].

    Or as steps find them that begin so many periods later, (T - later,).
    """
    assert judge.swept.all()
    ball, at, radii = ball_of(points, seed), centres(speed)[later:], judge.A
    Q = Q[: len(at)]
    if points == 0:
        ball = np.array([[0.0, 0.0, 0.0, RADIUS]])
    a, b = judge.hulls(judge.kinematics.place(Q))
    whole = np.linalg.norm(ball[0, :3]) + ball[0, 3]
    clear = np.full(len(Q), np.inf)
    for k in range(len(Q)):
        bounds = to_segment(at[k], a[k], b[k]) - radii - whole
        for hull in np.argsort(bounds):  # the nearest ones first
            if bounds[hull] > min(clear[k], CLEARANCE + LOOK):
                break
            to_balls = to_segment(at[k] + ball[:, :3], a[k, hull], b[k, hull])
            clear[k] = min(clear[k], (to_balls - radii[hull] - ball[:, 3]).min())
    return clear


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One crossing."""
    asked = (job["points"], job["speed"], job["seed"])
    judge = judge_of("panda")
    Q, said, absent = crossing(*asked, None)
    clear = clearances(judge, Q, *asked)
    struck = np.array([step.tracking == "deadline_struck" for step in said])
    without = crossing(*asked, UNHURRIED)[0]
    unhurried = clearances(judge, without, *asked)
    found = clearances(judge, without, *asked, later=1)
    moving = clearances(judge, crossing(*asked, UNHURRIED, told=True)[0], *asked, later=1)
    return [
        {
            "points": job["points"],
            "speed": job["speed"],
            "n": len(Q),
            "least": float(clear.min()),
            "short": int((clear < CLEARANCE - TOLERANCE).sum()),
            "struck": int(struck.sum()),
            "preempted": int((struck & (absent > PREEMPTED)).sum()),
            "unhurried": float(unhurried.min()),
            "found": float(found.min()),
            "found_told": float(moving.min()),
            "unhurried_short": int((unhurried < CLEARANCE - TOLERANCE).sum()),
        }
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """One for each run."""
    return [
        Line(
            what=f"ball of 8 cm across a Panda's forearm at {run.speed:g} m/s, "
            + (f"{run.points:,} balls" if run.points else "one sphere")
            + ": least clearance",
            asked=f"{1e3 * CLEARANCE:g} mm",
            measured=f"{millimetres(run.least)} mm, {run.struck} struck, {run.preempted} of them "
            f"preempted; without a deadline {millimetres(run.unhurried)} mm, as the next step "
            f"finds it {millimetres(run.found)} mm, with the ball's speed told "
            f"{millimetres(run.found_told)} mm",
            cases=f"{run.n:,} steps",
            failures=f"{run.short}; {run.unhurried_short} without",
        )
        for run in trials.itertuples()
    ]
