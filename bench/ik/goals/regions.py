"""A free tool axis, a tilt, a line, a plane, a look: solved of what can be, against a pose."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.common.intervals import duration
from bench.ik.goals.world import Kinematics, angle, quantiles, random_in
from bench.ik.lines import Line, jobs_of, share
from bench.ik.soak.solves import Row

SIZES = (2, 20)  # jobs
TARGETS = 50  # each
TILT = np.deg2rad(5)
LINE = 0.3  # half of it [m]
KINDS = ("pose", "free axis", "tilt of 5 degrees", "line", "plane", "look")
NEAR = 1e-5 + 1e-9


jobs = partial(jobs_of, robot=("panda", "ur10"))


def goal_of(kind: str, T: FloatArray) -> pdoik.Goal:
    """That a pose meets."""
    match kind:
        case "free axis":
            return pdoik.Goal(T, rotation_slack=[0, 0, np.pi])
        case "tilt of 5 degrees":
            return pdoik.Goal(T, type="axis", axis="z", rotation_slack=[TILT] * 3)
        case "line":
            return pdoik.Goal.region(T, position=([-LINE, 0, 0], [LINE, 0, 0]))
        case "plane":
            return pdoik.Goal.region(T, position=([-np.inf, -np.inf, 0], [np.inf, np.inf, 0]))
        case "look":
            return pdoik.Goal.look_at(T[:3, 3] + 0.4 * T[:3, 2])
        case _:
            return pdoik.Goal(T)


def is_met(kind: str, T: FloatArray, at: FloatArray) -> bool:
    """Whether a pose `at` (4, 4) is in the region about T, by definition."""
    off = T[:3, :3].T @ (at[:3, 3] - T[:3, 3])
    turned = angle(at[:3, :3].T @ T[:3, :3]) <= NEAR
    tilted = float(np.arccos(np.clip(at[:3, 2] @ T[:3, 2], -1, 1)))
    match kind:
        case "free axis":
            return bool(np.linalg.norm(off) <= NEAR and tilted <= NEAR + 1e-7)
        case "tilt of 5 degrees":
            return bool(np.linalg.norm(off) <= NEAR and tilted <= TILT + NEAR)
        case "line":
            return bool(turned and np.abs(off[1:]).max() <= NEAR and abs(off[0]) <= LINE + NEAR)
        case "plane":
            return bool(turned and abs(off[2]) <= NEAR)
        case "look":
            way = T[:3, 3] + 0.4 * T[:3, 2] - at[:3, 3]
            sine = np.linalg.norm(np.cross(at[:3, 2], way)) / np.linalg.norm(way)
            return bool(sine <= NEAR and at[:3, 2] @ way > 0)
        case _:
            return bool(turned and np.linalg.norm(off) <= NEAR)


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """All kinds of each target, in turns."""
    rng = np.random.default_rng([job["seed"], 5, job["index"]])
    robot = pdoik.Robot.builtin(job["robot"])
    kinematics = Kinematics(shipped(job["robot"]), robot.joint_names)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.1, self_collision=False))
    rows = []
    for _ in range(TARGETS):
        kinematics.place(random_in(robot, rng))
        T = kinematics.link(robot.tip_links[0]).copy()
        for kind in KINDS:
            result = solver.solve(goal_of(kind, T))
            kinematics.place(result.q)
            met = is_met(kind, T, kinematics.link(robot.tip_links[0]))
            rows.append(
                {
                    "robot": job["robot"],
                    "kind": kind,
                    "solved": result.success,
                    "wrong": result.success and not met,
                    "time": result.time,
                }
            )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of each kind compared with a pose."""
    found = []
    for name, of_robot in trials.groupby("robot"):
        usual = of_robot[of_robot.kind == "pose"].time.median()
        for kind in KINDS[1:]:
            some = of_robot[of_robot.kind == kind]
            median, worst = quantiles(some.time.to_numpy())
            found.append(
                Line(
                    what=f"{name}, {kind}: solved of feasible; time over a pose's",
                    asked="0.999; at most 1.5",
                    measured=f"{share(some.solved, len(some))}; {median / usual:.2f} "
                    f"({duration(median)}, 99 %: {duration(worst)})",
                    cases=f"{len(some):,}",
                    failures=int(some.wrong.sum()),
                )
            )
    return found
