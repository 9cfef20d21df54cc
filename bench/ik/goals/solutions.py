"""All solutions of a UR10, compared with EAIK's, and many of a Panda among nine objects.

EAIK's come from the same axes as Pinocchio has them. One of ours is wrong if Pinocchio says so;
complete is a pose of which each of EAIK's that is inside limits is among ours, and, where there are
objects, each of those that NumPy finds clear.
"""

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.common.intervals import duration
from bench.ik.goals.world import (
    POSITION,
    ROTATION,
    Kinematics,
    PointJudge,
    angle,
    quantiles,
    random_in,
)
from bench.ik.lines import Line, jobs_of, share
from bench.ik.soak.solves import Row

SIZES = (2, 20)  # jobs
POSES = 50  # each
ALIKE = 5e-3  # of joints [rad]
TOUCHES = 2e-6  # what is this near to contact counts neither way [m]
LIMIT = 32
OBJECTS, ON_EACH = 9, 40
ASKED = {"free": 100e-6, "among objects": 300e-6, "panda": 1e-3}


jobs = jobs_of


def nine_objects(rng: np.random.Generator) -> FloatArray:
    """Points on nine boxes about an arm, (360, 3)."""
    points = []
    for k in range(OBJECTS):
        turn = 2 * np.pi * (k + rng.uniform(0, 0.5)) / OBJECTS
        centre = rng.uniform(0.5, 0.9) * np.array([np.cos(turn), np.sin(turn), 0.0])
        centre[2] = rng.uniform(0.0, 0.7)
        local = rng.uniform(-1, 1, (ON_EACH, 3))
        local[np.arange(ON_EACH), rng.integers(3, size=ON_EACH)] = rng.choice([-1, 1], ON_EACH)
        points.append(centre + local * rng.uniform(0.03, 0.08, 3))
    return np.concatenate(points)


class Analytic:
    """EAIK's solutions of a shipped arm."""

    def __init__(self, robot: pdoik.Robot, kinematics: Kinematics) -> None:
        kinematics.place(np.zeros(robot.dof))
        pin: Any = importlib.import_module("pinocchio")
        model = pin.buildModelFromUrdf(str(shipped("ur10")))
        data = model.createData()
        pin.forwardKinematics(model, data, np.zeros(robot.dof))
        axes = [data.oMi[k].rotation[:, _axis_of(model, k)] for k in range(1, robot.dof + 1)]
        places = [data.oMi[k].translation for k in range(1, robot.dof + 1)]
        self._tip = kinematics.link(robot.tip_links[0])
        steps = [places[0], *np.diff(places, axis=0), self._tip[:3, 3] - places[-1]]
        hp = importlib.import_module("eaik.IK_HP")
        self._arm = hp.HPRobot(np.array(axes), np.array(steps))
        self._robot = robot

    def __call__(self, T: FloatArray) -> FloatArray:
        """Those inside limits, (K, 6)."""
        target = T.copy()
        target[:3, :3] = T[:3, :3] @ self._tip[:3, :3].T
        found = self._arm.IK(target)
        exact = [q for q, least in zip(found.Q, found.is_LS, strict=True) if not least]
        own = np.array(exact).reshape(-1, 6)
        wrapped = np.remainder(own + np.pi, 2 * np.pi) - np.pi
        inside = (wrapped >= self._robot.lower) & (wrapped <= self._robot.upper)
        kept: FloatArray = wrapped[inside.all(axis=1)]
        return kept


def _axis_of(model: Any, joint: int) -> int:
    return {"X": 0, "Y": 1, "Z": 2}[model.joints[joint].shortname()[-1]]


def _among(q: FloatArray, others: FloatArray) -> bool:
    off = np.remainder(others - q + np.pi, 2 * np.pi) - np.pi
    return bool(len(others) and (np.abs(off).max(axis=1) < ALIKE).any())


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Free, among objects, and the Panda."""
    rng = np.random.default_rng([job["seed"], 2, job["index"]])
    points = nine_objects(rng)
    rows = []
    robot = pdoik.Robot.builtin("ur10")
    kinematics = Kinematics(shipped("ur10"), robot.joint_names)
    analytic = Analytic(robot, kinematics)
    judge = PointJudge("ur10", robot)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.1, self_collision=False))
    cloud = pdoik.Cloud(points)
    solver.solve_all(robot.fk(robot.mid_configuration()), obstacles=cloud)
    poses = []
    for _ in range(POSES):
        kinematics.place(random_in(robot, rng))
        poses.append(kinematics.link(robot.tip_links[0]).copy())
    for kind in ("free", "among objects"):
        among = cloud if kind != "free" else None
        answers = [solver.solve_all(T, obstacles=among) for T in poses]  # in a row, as programs do
        for T, all_of in zip(poses, answers, strict=True):
            theirs = analytic(T)
            clear = [judge.clearance(q, points) if among else np.inf for q in theirs]
            missed = sum(
                gap > TOUCHES and not _among(q, all_of.q)
                for q, gap in zip(theirs, clear, strict=True)
            )
            wrong = sum(_is_wrong(kinematics, robot, each, T) for each in all_of)
            if among:
                wrong += sum(judge.clearance(q, points) < -TOUCHES for q in all_of.q)
            rows.append(
                {
                    "kind": kind,
                    "found": len(all_of),
                    "theirs": int(sum(gap > TOUCHES for gap in clear)),
                    "missed": int(missed),
                    "wrong": int(wrong),
                    "says_complete": all_of.complete,
                    "time": all_of.time,
                }
            )
    return rows + _of_panda(rng, points)


def _is_wrong(kinematics: Kinematics, robot: pdoik.Robot, each: Any, T: FloatArray) -> bool:
    kinematics.place(each.q)
    at = kinematics.link(robot.tip_links[0])
    return bool(
        np.linalg.norm(at[:3, 3] - T[:3, 3]) > POSITION + 1e-9
        or angle(at[:3, :3].T @ T[:3, :3]) > ROTATION + 1e-9
    )


def _of_panda(rng: np.random.Generator, points: FloatArray) -> list[Row]:
    robot = pdoik.Robot.builtin("panda")
    kinematics = Kinematics(shipped("panda"), robot.joint_names)
    judge = PointJudge("panda", robot)
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.02))
    cloud, rows, poses = pdoik.Cloud(points), [], []
    while len(poses) < POSES // 2:
        q = random_in(robot, rng)
        kinematics.place(q)
        T = kinematics.link(robot.tip_links[0]).copy()
        if solver.judge(T, q, obstacles=cloud).success:
            poses.append(T)
    answers = [solver.solve_all(T, LIMIT, obstacles=cloud) for T in poses]
    for T, all_of in zip(poses, answers, strict=True):
        near = [np.abs(all_of.q[:k] - all_of.q[k]).max(axis=1) for k in range(1, len(all_of))]
        wrong = sum(_is_wrong(kinematics, robot, each, T) for each in all_of)
        wrong += sum(judge.clearance(each, points) < -TOUCHES for each in all_of.q)
        wrong += sum((gaps < 0.1).any() for gaps in near)
        rows.append(
            {
                "kind": "panda",
                "found": len(all_of),
                "theirs": LIMIT,
                "missed": max(0, LIMIT - len(all_of)),
                "wrong": int(wrong),
                "says_complete": all_of.complete,
                "time": all_of.time,
            }
        )
    return rows


def lines(trials: pd.DataFrame) -> list[Line]:
    """Completeness and times."""
    found = []
    for kind, asked in ASKED.items():
        some = trials[trials.kind == kind]
        median, worst = quantiles(some.time.to_numpy())
        whole = share(some.missed == 0, len(some))
        what = (
            f"{LIMIT} distinct solutions of a Panda among {OBJECTS} objects: poses that gave them"
            if kind == "panda"
            else f"all solutions of a UR10, {kind}: poses where none of EAIK's is missing"
        )
        found.append(
            Line(
                what=what,
                asked=f"1.000, 0 wrong, {duration(asked)}",
                measured=f"{whole}, median {duration(median)} (99 %: {duration(worst)}); "
                f"{some.found.mean():.1f} each",
                cases=f"{len(some):,} poses",
                failures=int(some.wrong.sum()),
            )
        )
    return found
