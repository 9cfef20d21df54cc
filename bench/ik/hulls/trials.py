"""Scenes solved with many occupancies and clouds, judged on meshes."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pdoik
from bench.ik.experiment import ARMS, Arm
from bench.ik.hulls.fits import hull_stages, occupancy
from bench.ik.scenes.around import (
    arm_named,
    mesh_judge,
    models_of,
    random_scene_around,
    start_configuration,
)

OBJECTS = 9
SHIPPED = "shipped"
BASE_LEFT_OUT = "shipped, base not counted"
CAPSULES = "shipped, capsules"  # within the hulls that `shipped` has; self-collision is off
HULLS: tuple[int | str, ...] = (1, 2, 3, 4, SHIPPED, BASE_LEFT_OUT, CAPSULES)  # most per link
CLOUDS = (  # leaf [m], whether points get covering radii, growth of the radii [m]
    (0.1, False, 0.0),
    (0.05, False, 0.0),
    (0.05, True, 0.0),
    (0.03, True, 0.0),
    (0.02, False, 0.0),
    (0.02, True, 0.0),
    (0.02, True, 0.005),
    (0.01, False, 0.0),
    (0.01, False, 0.003),
    (0.01, True, 0.0),
)


def run_block(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """All occupancies and clouds on some consecutive scenarios of one arm."""
    arm, judge, models = arm_named(job["robot"]), mesh_judge(job["robot"]), models_of(job["ycb"])
    q0 = start_configuration(arm)
    rows = []
    for index in range(job["first"], job["first"] + job["count"]):
        seed = [job["seed"], ARMS.index(arm.name), OBJECTS, index]
        q, scene, bodies = random_scene_around(arm, judge, models, OBJECTS, seed)
        T_base_tip = arm.robot.fk(q)
        for leaf, radii, growth in CLOUDS:
            cloud = pdoik.voxel_downsample(scene.points, leaf, radii=radii)
            if radii:
                cloud[:, 3] += growth
            elif growth:
                cloud = np.column_stack([cloud, np.full(len(cloud), growth)])
            for hulls in job["hulls"]:
                solver = _solver(arm.name, hulls, job["fits"])
                result = solver.solve(T_base_tip, q0, cloud)
                collision = judge.collision(result.q, bodies) if result.success else None
                rows.append(
                    {
                        "robot": arm.name,
                        "index": index,
                        "leaf": leaf,
                        "radii": radii,
                        "growth": growth,
                        "hulls": str(hulls),
                        "n_hulls": len(solver.robot.occupancy),
                        "n_points": len(cloud),
                        "status": result.status,
                        "solved": result.success,
                        "collision": collision or "",
                        "time": result.time,
                        "known_is_clear": solver.judge(T_base_tip, q, cloud).success,
                    }
                )
    return rows


@cache
def _solver(robot: str, hulls: int | str, fits: str) -> pdoik.Solver:
    arm = Arm.builtin(robot)
    if isinstance(hulls, int):
        arm.robot.occupancy = occupancy(hull_stages(arm, Path(fits)), hulls)
    elif hulls == CAPSULES:
        arm.robot.occupancy = pdoik.Robot.builtin(robot).occupancy
    options = pdoik.Options(
        goal="axis",
        position_tolerance=0.01,
        rotation_tolerance=0.01,
        max_time=0.1,
        base_collision=hulls != BASE_LEFT_OUT,
        self_collision=False,
        max_obstacles=16384,
    )
    return pdoik.Solver(arm.robot, options)
