"""Any one of 64 grasps, of which one can be had: what that takes, against that one alone.

`about one object`: poses about one place that cannot be met in a long search, most of them because
no posture reaches them, some because all that do touch something. `far`: poses out of reach.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.common.intervals import duration
from bench.ik.goals.world import POSITION, ROTATION, Kinematics, PointJudge, angle, quantiles
from bench.ik.lines import Line, jobs_of, share
from bench.ik.soak.solves import Row

SIZES = (2, 10)  # scenes
GRASPS, POINTS, ASKED = 64, 150, 3.0
KINDS = ("about one object", "far")


jobs = jobs_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """Grasps of which one can be had."""

    kind: str
    attempt: int
    poses: FloatArray  # (64, 4, 4)
    good: int  # which that is


def choices(rng: np.random.Generator, robot: pdoik.Robot, points: FloatArray) -> Iterator[Choice]:
    """Both kinds, as often as a scene gives them in four attempts."""
    long = pdoik.Solver(robot, pdoik.Options(max_time=0.3, max_restarts=3000))
    for attempt in range(4):
        centre = rng.uniform([0.3, -0.6, 0.0], [0.95, 0.6, 0.8])
        poses = _about(centre, rng)
        known = long.solve_batch(poses, obstacles=points)
        good, bad = np.flatnonzero(known.success), np.flatnonzero(~known.success)
        if len(good) == 0 or len(bad) < GRASPS // 3:
            continue
        others = {
            KINDS[0]: poses[bad[rng.integers(len(bad), size=GRASPS - 1)]],
            KINDS[1]: _far(rng),
        }
        for kind, rest in others.items():
            place = int(rng.integers(GRASPS))
            all_of = np.insert(rest, place, poses[good[0]], axis=0)
            yield Choice(kind=kind, attempt=attempt, poses=all_of, good=place)


def scene(rng: np.random.Generator) -> FloatArray:
    """Points about an arm, (150, 3)."""
    return rng.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.0], (POINTS, 3))


def is_had(at: FloatArray, pose: FloatArray, clearance: float) -> bool:
    """Whether a hand is at a grasp, and the arm clear."""
    return bool(
        np.linalg.norm(at[:3, 3] - pose[:3, 3]) <= POSITION + 1e-9
        and angle(at[:3, :3].T @ pose[:3, :3]) <= ROTATION + 1e-9
        and clearance >= -1e-6 - 1e-9
    )


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Both kinds, as often as a scene gives them."""
    rng = np.random.default_rng([job["seed"], 1, job["index"]])
    robot = pdoik.Robot.builtin("panda")
    points = scene(rng)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=1.0))
    judge = PointJudge("panda", robot)
    kinematics = Kinematics(shipped("panda"), robot.joint_names)
    rows = []
    for choice in choices(rng, robot, points):
        alone = solver.solve(choice.poses[choice.good], obstacles=points)
        any_of = solver.solve_any(choice.poses, obstacles=points)
        kinematics.place(any_of.q)
        at = kinematics.link(robot.tip_links[0])
        met, clearance = choice.poses[any_of.goal_index], judge.clearance(any_of.q, points)
        rows.append(
            {
                "kind": choice.kind,
                "attempt": choice.attempt,
                "solved": any_of.success,
                "wrong": any_of.success and not is_had(at, met, clearance),
                "that_one": any_of.goal_index == choice.good,
                "alone": alone.time - alone.intake,
                "any": any_of.time - any_of.intake,
                "starts_alone": alone.restarts + 1,
                "starts": any_of.restarts + 1,
            }
        )
    return rows


def _about(centre: FloatArray, rng: np.random.Generator) -> FloatArray:
    """A hand's poses that face a place from all sides, (64, 4, 4)."""
    poses = np.tile(np.eye(4), (GRASPS, 1, 1))
    poses[:, :3, :3] = Rotation.random(GRASPS, random_state=rng).as_matrix()
    poses[:, :3, 3] = centre - 0.1 * poses[:, :3, 2] + 0.02 * rng.normal(size=(GRASPS, 3))
    return poses


def _far(rng: np.random.Generator) -> FloatArray:
    poses = np.tile(np.eye(4), (GRASPS - 1, 1, 1))
    poses[:, :3, :3] = Rotation.random(GRASPS - 1, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.uniform([-1, -1, -2.6], [1, 1, -0.6], (GRASPS - 1, 3))
    return poses


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines with the times of each kind next to each other."""
    found = []
    for kind in KINDS:
        some = trials[trials.kind == kind]
        if some.empty:
            continue
        ratio = some["any"].median() / some.alone.median()
        median, worst = quantiles(some["any"].to_numpy())
        found.append(
            Line(
                what=f"any of {GRASPS} grasps {kind}: median time over that of the one alone",
                asked=f"at most {ASKED:.0f}",
                measured=f"{ratio:.1f}: {duration(median)} (99 %: {duration(worst)}) and "
                f"{duration(some.alone.median())}, {some.starts.median():.0f} and "
                f"{some.starts_alone.median():.0f} starts; solved {share(some.solved, len(some))}",
                cases=f"{len(some):,}",
                failures=int(some.wrong.sum()),
            )
        )
    return found
