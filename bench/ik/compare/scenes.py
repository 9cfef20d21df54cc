"""The paper's first experiment: 5-DoF goals among nine random objects, seen as a cloud."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import pdoik
from bench.common.timings import Block, Row, Solve
from bench.ik.experiment import Advance, Arm, FloatArray, take_turns
from bench.ik.judges.recheck import UrdfChain, recheck
from bench.ik.scenes.objects import ObjectModel, Scene, random_scene

OBJECTS = 9
LEAF = 0.1  # [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A target among points, both of which a known configuration satisfies."""

    T_base_tip: FloatArray  # (4, 4)
    cloud: FloatArray  # (N, 3), [m]


def solve_scenes(
    arms: list[Arm],
    models: Sequence[ObjectModel],
    scenes: int,
    seed: int,
    source: str,
    advance: Advance,
) -> Block:
    """The default solver on scenes known to be feasible; plain NumPy checks its answers."""
    rows: list[Row] = []
    points: list[str] = []
    for index, arm in enumerate(arms):
        rng = np.random.default_rng([seed, index])
        solver = pdoik.Solver(arm.robot, pdoik.Options(goal="axis", goal_axis="z"))
        tasks = [_random_task(arm, solver, models, rng) for _ in range(scenes)]
        chain = UrdfChain(arm.urdf, arm.robot.joint_names)

        def solve(
            task: Task, arm: Arm = arm, solver: pdoik.Solver = solver, chain: UrdfChain = chain
        ) -> Solve:
            result = solver.solve(task.T_base_tip, obstacles=task.cloud)
            verdict = recheck(
                chain, arm.robot, solver.options, task.T_base_tip, result.q, task.cloud
            )
            return Solve(
                claimed=result.success,
                confirmed=verdict.confirms(solver.options),
                time=result.time,
                iterations=result.iterations,
                restarts=result.restarts,
            )

        rows.append(
            Row.of(arm.name, "pdoik", take_turns({"pdoik": solve}, tasks, advance)["pdoik"])
        )
        points.append(f"{np.mean([len(task.cloud) for task in tasks]):.0f}")
    return Block(
        title=f"{scenes} scenes per arm: {OBJECTS} objects, 5-DoF goals, default options",
        rows=rows,
        notes=[
            f"Objects: {source}, scaled 1 to 3 times, voxel grid of {LEAF:g} m over the scene.",
            "The configuration that defines the target is clear. The cloud is set before timing.",
        ],
        extra={"points": points},
    )


def _random_task(
    arm: Arm, solver: pdoik.Solver, models: Sequence[ObjectModel], rng: np.random.Generator
) -> Task:
    q = arm.random_configuration(rng)
    T_base_tip = arm.robot.fk(q)

    def is_clear(scene: Scene) -> bool:
        return solver.judge(T_base_tip, q, obstacles=scene.cloud(LEAF)).clearance > 0

    scene = random_scene(rng, models, OBJECTS, is_clear)
    return Task(T_base_tip=T_base_tip, cloud=scene.cloud(LEAF))
