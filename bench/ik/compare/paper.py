"""Algorithm IK from one start: the library's `method="paper"` and cpp/testing's plain one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pdoik
from bench.common.timings import Block, Row, Solve
from bench.ik.experiment import Advance, Arm, FloatArray, Goal, take_turns

TOLERANCE = 0.01  # [m] and [rad], the paper's
CONTACT_TOLERANCE = 1e-3  # c_tol, which the paper does not give [m]
MAX_TIME = 60.0  # the paper's [s]
BOXES = 9
POINTS_PER_EDGE = 3  # 27 points per box, 243 in all
PLAIN = "libpdoik_peer_plain.so"

# Solved from one start by the prototype of the notes on the paper, on targets and hulls of its own.
PROTOTYPE = {
    ("pose", 0): {"ur10": 0.91, "iiwa14": 0.94, "panda": 0.76},
    ("axis", 0): {"ur10": 0.89, "iiwa14": 0.97, "panda": 0.86},
    ("axis", BOXES): {"ur10": 0.82, "iiwa14": 0.95, "panda": 0.81},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A target among points."""

    T_base_tip: FloatArray  # (4, 4)
    cloud: FloatArray  # (N, 3), [m]


def repeat_paper(
    arms: list[Arm],
    libraries: Path,
    goal: Goal,
    boxes: int,
    targets: int,
    seed: int,
    advance: Advance,
) -> Block:
    """Both on the same tasks from omega = 0; the library's judge sees all answers."""
    rows: list[Row] = []
    prototype: list[str] = []
    for index, arm in enumerate(arms):
        rng = np.random.default_rng([seed, index])
        solver = pdoik.Solver(arm.robot, _options(goal))
        tasks = [_random_task(arm, solver, boxes, rng) for _ in range(targets)]
        methods = {
            "paper": _library(solver),
            "plain scalar": _plain(arm, solver, libraries / PLAIN, goal),
        }
        solves = take_turns(methods, tasks, advance)
        rows += [Row.of(arm.name, name, solves[name]) for name in methods]
        prototype += [f"{PROTOTYPE[goal, boxes][arm.name]:.2f}", ""]
    points = BOXES * POINTS_PER_EDGE**3 if boxes else 0
    return Block(
        title=f"Algorithm IK from omega = 0: {6 if goal == 'pose' else 5}-DoF, {points} points",
        rows=rows,
        notes=[
            f"{targets} targets per arm, {TOLERANCE:g} m and rad, contact {CONTACT_TOLERANCE:g} m."
        ],
        extra={"prototype": prototype},
    )


def _options(goal: Goal) -> pdoik.Options:
    return pdoik.Options(
        goal=goal,
        method="paper",
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        clearance_tolerance=CONTACT_TOLERANCE,
        augmented_lagrangian=pdoik.AugmentedLagrangianOptions(
            constraint_tolerance=CONTACT_TOLERANCE
        ),
        max_time=MAX_TIME,
    )


def _library(solver: pdoik.Solver) -> Callable[[Task], Solve]:
    def solve(task: Task) -> Solve:
        result = solver.solve(task.T_base_tip, obstacles=task.cloud)
        verdict = solver.judge(task.T_base_tip, result.q, obstacles=task.cloud)
        return Solve(
            claimed=result.success,
            confirmed=verdict.success,
            time=result.time,
            iterations=result.iterations,
            restarts=result.restarts,
        )

    return solve


def _plain(arm: Arm, solver: pdoik.Solver, library: Path, goal: Goal) -> Callable[[Task], Solve]:
    peer = arm.peer(
        library,
        occupancy_yaml=arm.robot.occupancy.to_yaml(),
        goal=goal,
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        clearance_tolerance=CONTACT_TOLERANCE,
        max_time=MAX_TIME,
    )

    def solve(task: Task) -> Solve:
        answer = peer.solve(task.T_base_tip, obstacles=task.cloud)
        success = solver.judge(task.T_base_tip, answer.q, obstacles=task.cloud).success
        return Solve(
            claimed=success,  # it makes no claim of its own
            confirmed=success,
            time=answer.time,
            iterations=answer.iterations,
            restarts=0,
        )

    return solve


def _random_task(arm: Arm, solver: pdoik.Solver, boxes: int, rng: np.random.Generator) -> Task:
    """Boxes of 6 to 30 cm where the paper puts obstacles, each clear of the configuration."""
    q = arm.random_configuration(rng)
    T_base_tip = arm.robot.fk(q)
    lattice = np.stack(np.meshgrid(*3 * [np.linspace(-1, 1, POINTS_PER_EDGE)]), axis=-1).reshape(
        -1, 3
    )
    cloud = np.empty((0, 3))
    while len(cloud) < boxes * len(lattice):
        center = rng.uniform((-0.6, -0.6, 0.0), (0.6, 0.6, 1.2))
        box = center + rng.uniform(0.03, 0.15, 3) * lattice
        if solver.judge(T_base_tip, q, obstacles=box).clearance > 0:
            cloud = np.concatenate([cloud, box])
    return Task(T_base_tip=T_base_tip, cloud=cloud)
