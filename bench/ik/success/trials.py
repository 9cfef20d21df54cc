"""The paper's first experiment, trial by trial: methods and criteria (Sec. exp1)."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.experiment import ARMS
from bench.ik.judges.meshes import Body
from bench.ik.methods import Answer, Problem, Terms
from bench.ik.scenes.around import (
    arm_named,
    chain_of,
    itself_judge,
    mesh_judge,
    models_of,
    prepared_method,
    random_scene_around,
    start_configuration,
)

LIMIT_TOLERANCE = 0.01  # criterion 4, of each joint's range


def scenario_seed(seed: int, robot: str, n_objects: int, index: int) -> list[int]:
    """What one scenario of the campaign with this seed is drawn from."""
    return [seed, sorted(ARMS).index(robot), n_objects, index]


def verdict(
    robot: str, T_base_tip: FloatArray, objects: Sequence[Body], answer: Answer, terms: Terms
) -> dict[str, Any]:
    """Errors and which of the paper's four criteria hold, by none of the library's functions."""
    chain = chain_of(robot)
    T = chain.fk(answer.q, arm_named(robot).tip_link)
    axis = "xyz".index(terms.goal_axis)
    a, b = T[:3, axis], T_base_tip[:3, axis]
    position_error = float(np.linalg.norm(T[:3, 3] - T_base_tip[:3, 3]))
    rotation_error = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    lower, upper = chain.limits.T
    beyond = float((np.maximum(lower - answer.q, answer.q - upper) / (upper - lower)).max())
    collision = mesh_judge(robot).collision(answer.q, objects)
    in_time = answer.time <= terms.max_time
    fails = {
        "fails_limits": beyond > LIMIT_TOLERANCE,
        "fails_collision": collision is not None,
        "fails_pose": position_error >= terms.position_tolerance
        or rotation_error >= terms.rotation_tolerance,
    }
    return {
        "position_error": position_error,
        "rotation_error": rotation_error,
        "limit_violation": max(beyond, 0.0),
        "collision": collision or "",
        "in_time": in_time,
        **fails,
        "meets_itself": itself_judge(robot)(answer.q),  # no criterion of the paper's
        "success": in_time and not any(fails.values()),
    }


def run_block(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The trials of some consecutive scenarios of one arm and number of objects.

    Args:
        job: robot, n_objects, first, count, seed, leaf, ycb, max_time, tolerance [m] and [rad]; and
            methods, a list of (name, goal axis, number of scenarios that it takes part in).
    """
    robot, n_objects = job["robot"], job["n_objects"]
    arm, q0 = arm_named(robot), start_configuration(arm_named(robot))
    rows = []
    for index in range(job["first"], job["first"] + job["count"]):
        q, scene, bodies = random_scene_around(
            arm,
            mesh_judge(robot),
            models_of(job["ycb"]),
            n_objects,
            scenario_seed(job["seed"], robot, n_objects, index),
        )
        T_base_tip, cloud = arm.robot.fk(q), scene.cloud(job["leaf"])
        for name, axis, count in job["methods"]:
            if index >= count:
                continue
            terms = Terms(
                goal_axis=axis,
                position_tolerance=job["tolerance"],
                rotation_tolerance=job["tolerance"],
                max_time=job["max_time"],
            )
            method = prepared_method(name, robot, terms)
            answer = method.solve(Problem(T_base_tip=T_base_tip, q0=q0, points=cloud))
            rows.append(
                {
                    "robot": robot,
                    "n_objects": n_objects,
                    "index": index,
                    "axis": axis,
                    "method": name,
                    "language": method.language,
                    "n_points": len(cloud),
                    **answer.row(),
                    **verdict(robot, T_base_tip, bodies, answer, terms),
                    "finished": time.time(),
                }
            )
    return rows
