"""A robot without hulls behind a goal that moves at 0.25 m/s along a way its joints can go."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.lines import Jobs, Line, millimetres
from bench.ik.safety.world import ARMS, PERIOD, UNHURRIED, without_hulls
from bench.ik.soak.judge import Asked, Goals, Judge, random_configurations
from bench.ik.soak.robots import builtin_spec
from bench.ik.soak.solves import Row

SIZES = (3, 30)  # runs
SPEED = 0.25  # of the goal [m/s]
STEPS = 4000
FINE = 20_000  # pieces that a way is measured in
ROOM = 0.9  # share of its speed limit that a joint needs at most
TOLERANCE = 1e-5  # [m] and [rad]


def jobs(size: int, seed: int) -> Jobs:
    """The arms by turns, a pose and a position by turns."""
    return {
        f"{ARMS[k % 3]}-{k:03d}": {
            "robot": ARMS[k % 3],
            "type": ("pose", "position")[k // 3 % 2],
            "seed": seed,
            "index": k,
        }
        for k in range(size)
    }


def way(judge: Judge, rng: np.random.Generator) -> FloatArray:
    """Configurations, (STEPS, n), whose tip moves at SPEED and whose joints are fast enough."""
    kinematics = judge.kinematics
    while True:
        about = random_configurations(kinematics, 1, rng)[0]
        turns, phase = rng.uniform(0.2, 1.0, (2, len(about)))
        s = np.linspace(0.0, 1.0, FINE)[:, None]
        room = np.minimum(about - kinematics.lower, kinematics.upper - about)
        size = np.minimum(room, 1.0) * rng.uniform(0.2, 0.9, len(about))
        q = about + size * np.sin(2 * np.pi * (4 * turns * s + phase))
        _, p = kinematics.link(kinematics.place(q), kinematics.spec.tip_links[0])
        length = np.r_[0.0, np.linalg.norm(np.diff(p, axis=0), axis=1).cumsum()]
        if length[-1] < SPEED * PERIOD * STEPS:
            continue
        at = np.interp(SPEED * PERIOD * np.arange(STEPS), length, s[:, 0])
        path = about + size * np.sin(2 * np.pi * (4 * turns * at[:, None] + phase))
        if (np.abs(np.diff(path, axis=0)) < ROOM * PERIOD * kinematics.velocity).all():
            return np.asarray(path)


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One run."""
    spec = without_hulls(builtin_spec(job["robot"]))
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    path = way(judge, np.random.default_rng([job["seed"], 12, job["index"]]))
    R, p = judge.kinematics.link(judge.kinematics.place(path), spec.tip_links[0])
    T = np.tile(np.eye(4), (len(path), 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, p
    solver = pdoik.Solver(robot, pdoik.Options(goal=job["type"]))
    tracker = pdoik.Tracker(solver, PERIOD, max_time=UNHURRIED)
    tracker.reset(path[0])
    Q = np.array([tracker.step(target).q for target in T])
    verdicts = judge([Goals(tip=spec.tip_links[0], T=T, type=job["type"])], Q, Asked())
    lag, turned = verdicts.position_error, verdicts.rotation_error
    late = (lag > TOLERANCE) | (turned > TOLERANCE)
    return [
        {
            **{name: job[name] for name in ("robot", "type", "index")},
            "n": len(Q),
            "lag": float(lag.max()),
            "turned": float(turned.max()),
            "late": int(late.sum()),
            "first": int(np.argmax(late)),
        }
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of all runs, and how many are ever behind."""
    behind = trials[trials.late > 0]
    return [
        Line(
            what="robots without hulls behind a goal that moves at 0.25 m/s: greatest lag",
            asked="0.01 mm and mrad",
            measured=f"{millimetres(trials.lag.max())} mm, "
            f"{millimetres(trials.turned.max())} mrad; {int(trials.late.sum()):,} steps behind",
            cases=f"{len(trials)} runs, {int(trials.n.sum()):,} steps",
            failures=len(behind),
        )
    ]
