"""Two hands on one box, whose own pose is only loosely given; and joints that are idle."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.common.intervals import duration
from bench.ik.goals.world import Kinematics, angle, model_file, quantiles, random_in
from bench.ik.lines import Line, jobs_of, share
from bench.ik.soak.solves import Row

SIZES = (2, 20)  # jobs
BOXES = 25  # each
GRIP = 1e-6  # [m], [rad]
ROBOTS = ("two FR3", "H1")
TABLE = -0.05  # its top [m]


jobs = partial(jobs_of, robot=ROBOTS)


def two_arms() -> tuple[pdoik.Robot, str, tuple[str, str], dict[str, Any]]:
    """Two FR3 in the Panda's hulls, which has the same links."""
    text = pdoik.urdf_text(model_file("franka_robot_model/dual_fr3.urdf"))
    tips = ("left_fr3_hand_tcp", "right_fr3_hand_tcp")
    robot = pdoik.Robot.from_urdf(text, tip_link=list(tips))
    panda = pdoik.Robot.builtin("panda")

    def named(side: str, link: str) -> str:
        return f"{side}_{link.replace('panda', 'fr3')}"

    sides = ("left", "right")
    robot.occupancy = pdoik.Occupancy(
        capsules=[
            (named(side, link), *rest) for side in sides for link, *rest in panda.occupancy.capsules
        ]
    )
    robot.ignored_pairs = [
        (named(side, one), named(side, other))
        for side in sides
        for one, other in panda.ignored_pairs
    ]
    return robot, text, tips, {"self_collision": True}


def humanoid() -> tuple[pdoik.Robot, str, tuple[str, str], dict[str, Any]]:
    """An H1, whose hands are its elbows' links."""
    robot = pdoik.Robot.builtin("h1")
    return robot, str(shipped("h1")), ("left_elbow_link", "right_elbow_link"), {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """What two hands are asked for, which can be had by construction."""

    grip: FloatArray  # the other hand in the one's frame, (4, 4)
    middle: FloatArray  # of the region for the one hand, (4, 4)
    slack: tuple[FloatArray, FloatArray]  # of its place [m] and turn [rad] about that
    q0: FloatArray


def table() -> list[pdoik.Shape]:
    """What two FR3 stand on."""
    return [pdoik.Shape.half_space("table", [0, 0, 1], [0, 0, TABLE])]


def boxes(
    rng: np.random.Generator,
    solver: pdoik.Solver,
    kinematics: Kinematics,
    tips: tuple[str, str],
    obstacles: list[pdoik.Shape] | None,
) -> Iterator[Box]:
    """Without end, each from a posture that holds it."""
    robot, (one, other) = solver.robot, tips
    while True:
        q = random_in(robot, rng)
        kinematics.place(q)
        held = {link: kinematics.link(link).copy() for link in tips}
        if not solver.judge(held, q, obstacles=obstacles).success:
            continue
        slack = rng.uniform(0.02, 0.1, 3), rng.uniform(0.05, 0.3, 3)
        middle = held[one] @ _within(rng, *slack)
        q0 = random_in(robot, rng)
        while solver.judge(held, q0).self_distance < 0:  # legs would have to make room
            q0 = random_in(robot, rng)
        grip = np.linalg.inv(held[one]) @ held[other]
        yield Box(grip=grip, middle=middle, slack=slack, q0=q0)


def goals_of(box: Box, tips: tuple[str, str]) -> list[pdoik.Goal]:
    """The region of the one hand, and the grip."""
    one, other = tips
    place, turn = box.slack
    return [
        pdoik.Goal(box.middle, tip=one, position_slack=place, rotation_slack=turn),
        pdoik.Goal(
            box.grip,
            tip=other,
            relative_to=one,
            position_tolerance=GRIP,
            rotation_tolerance=GRIP,
        ),
    ]


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Boxes that can be held, by construction."""
    rng = np.random.default_rng([job["seed"], 3, job["index"], ROBOTS.index(job["robot"])])
    robot, urdf, tips, more = two_arms() if job["robot"] == ROBOTS[0] else humanoid()
    kinematics = Kinematics(urdf, robot.joint_names)
    options = pdoik.Options(max_time=0.1, **more)
    solver = pdoik.Solver(robot, options)
    obstacles = table() if job["robot"] != "H1" else None
    rows = []
    for box in islice(boxes(rng, solver, kinematics, tips, obstacles), BOXES):
        goals = goals_of(box, tips)
        result = solver.solve(goals, q0=box.q0, obstacles=obstacles)
        idle, had_to = _idle(solver, goals, box.q0, result.q) if result.success else (0.0, False)
        rows.append(
            {
                "robot": job["robot"],
                "solved": result.success,
                "wrong": result.success
                and is_wrong(kinematics, result.q, *tips, box.grip, box.middle, *box.slack),
                "time": result.time,
                "idle": 0.0 if had_to else idle,
                "made_room": had_to,
            }
        )
    return rows


def _within(rng: np.random.Generator, place: FloatArray, turn: FloatArray) -> FloatArray:
    """A shift and turn inside some slack, (4, 4)."""
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(0.9 * turn * rng.uniform(-1, 1, 3)).as_matrix()
    T[:3, 3] = T[:3, :3] @ (0.9 * place * rng.uniform(-1, 1, 3))
    return T


def is_wrong(
    kinematics: Kinematics,
    q: FloatArray,
    one: str,
    other: str,
    grip: FloatArray,
    middle: FloatArray,
    place: FloatArray,
    turn: FloatArray,
) -> bool:
    kinematics.place(q)
    T, held = kinematics.link(one).copy(), kinematics.link(other).copy()
    off = np.linalg.inv(T @ grip) @ held
    apart = np.linalg.inv(middle) @ T
    turned = Rotation.from_matrix(apart[:3, :3]).as_rotvec()
    return bool(
        np.linalg.norm(off[:3, 3]) > GRIP + 1e-9
        or angle(off[:3, :3]) > GRIP + 1e-8
        or (np.abs(apart[:3, 3]) > place + 1.1e-5).any()
        or (np.abs(turned) > turn + 1.1e-5).any()
    )


def _idle(solver: pdoik.Solver, goals: Any, q0: FloatArray, q: FloatArray) -> tuple[float, bool]:
    """How far joints of the H1's legs went, which move no hand [rad]; whether they had to."""
    names = solver.robot.joint_names
    legs = [i for i, n in enumerate(names) if "hip" in n or "knee" in n or "ankle" in n]
    moved = float(np.abs(q - q0)[legs].max(initial=0.0))
    if moved == 0.0:
        return 0.0, False
    stayed = q.copy()
    stayed[legs] = q0[legs]
    return moved, not solver.judge(goals, stayed).success


def lines(trials: pd.DataFrame) -> list[Line]:
    """Solved of feasible."""
    found = []
    for name in ROBOTS:
        some = trials[trials.robot == name]
        if some.empty:
            continue
        median, worst = quantiles(some.time.to_numpy())
        idle = (
            [
                Line(
                    what=f"... joints of {name}'s legs, which move no hand: moved at most",
                    asked="0",
                    measured=f"{some.idle.max():g} rad; in {int(some.made_room.sum())} boxes they "
                    "had to make room for the arms",
                    cases=f"{len(some):,} boxes",
                    failures=int((some.idle > 0).sum()),
                )
            ]
            if name == "H1"
            else []
        )
        found.append(
            Line(
                what=f"two hands of {name} on one box, grip to {GRIP:g}, its pose in a region",
                asked="0.990, median 300 us",
                measured=f"{share(some.solved, len(some))}, median {duration(median)} "
                f"(99 %: {duration(worst)})",
                cases=f"{len(some):,} boxes",
                failures=int(some.wrong.sum()),
            )
        )
        found += idle
    return found
