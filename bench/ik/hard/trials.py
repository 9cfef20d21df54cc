"""Hard scenes, problem by problem: every method gets the same ones."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

import pdoik
from bench.ik.experiment import ARMS
from bench.ik.hard.scenes import FAMILIES, HardProblem, Maker
from bench.ik.judges.recheck import UrdfChain, recheck
from bench.ik.methods import Method, Problem, Terms, make_method
from bench.ik.success.trials import arm_named, mesh_judge, models_of

TOLERANCE = 1e-4  # [m] and [rad]
ROUNDING = 1e-6  # by which an answer may touch the hulls [m]


def run_block(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The trials of some consecutive problems of one family and arm.

    Args:
        job: robot, family, first, count, seed, ycb, max_time, libraries; and methods, a list of
            (name, number of problems that it takes part in). Each is solved with `repeats` seeds.
    """
    maker, chain = _maker(job["robot"], job["ycb"]), _chain(job["robot"])
    problems = [
        FAMILIES[job["family"]](maker, np.random.default_rng(_seed(job, index)))
        for index in range(job["first"], job["first"] + job["count"])
    ]
    rows = []
    for seed in range(job["repeats"]):
        for name, count in job["methods"]:
            method = prepared_method(name, job["robot"], job["max_time"], job["libraries"], seed)
            for index, problem in enumerate(problems, start=job["first"]):
                if index < count:
                    outcome = solve_and_judge(maker, chain, method, problem, job["max_time"])
                    head = {"robot": job["robot"], "family": job["family"], "index": index}
                    rows.append({**head, "method": name, "repeat": seed, **outcome})
    return rows


def solve_and_judge(
    maker: Maker, chain: UrdfChain, method: Method, problem: HardProblem, max_time: float
) -> dict[str, Any]:
    """One method's answer to one problem, judged by NumPy from the URDF and, on meshes, by coal."""
    robot = maker.arm.robot
    answer = method.solve(
        Problem(
            T_base_tip=problem.T_base_tip,
            q0=robot.mid_configuration(),
            points=problem.points,
            near_q0=False,
        )
    )
    options = pdoik.Options(
        position_tolerance=TOLERANCE, rotation_tolerance=TOLERANCE, clearance_tolerance=ROUNDING
    )
    verdict = recheck(chain, robot, options, problem.T_base_tip, answer.q, problem.points)
    collision = maker.judge.collision(answer.q, problem.bodies) if problem.bodies else None
    confirmed = verdict.confirms(options) and answer.time <= max_time
    return {
        "language": method.language,
        "n_points": len(problem.points),
        "claimed": answer.claimed,
        "confirmed": confirmed,
        "solved": answer.claimed and confirmed,
        "mesh_collision": collision or "",
        "time": answer.time,
        "iterations": answer.iterations,
        "restarts": answer.restarts,
        "position_error": verdict.position_error,
        "rotation_error": verdict.rotation_error,
        "limit_violation": verdict.limit_violation,
        "clearance": verdict.clearance,
        "q": answer.q.tolist(),
    }


def _seed(job: Mapping[str, Any], index: int) -> list[int]:
    return [job["seed"], ARMS.index(job["robot"]), list(FAMILIES).index(job["family"]), index]


@lru_cache
def _chain(robot: str) -> UrdfChain:
    arm = arm_named(robot)
    return UrdfChain(arm.urdf, arm.robot.joint_names)


@lru_cache
def _maker(robot: str, ycb: str | None) -> Maker:
    return Maker.of(arm_named(robot), mesh_judge(robot), models_of(ycb))


@cache
def prepared_method(name: str, robot: str, max_time: float, libraries: str, seed: int) -> Method:
    """A method that has solved one easy problem, so that no trial pays for its first call."""
    arm = arm_named(robot)
    terms = Terms(
        goal="pose",
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        max_time=max_time,
        seed=seed,
    )
    method = make_method(name, arm, terms, libraries=Path(libraries))
    q0 = arm.robot.mid_configuration()
    point = np.array([[0.0, 0.0, 5.0, 0.01]])
    method.solve(Problem(T_base_tip=arm.robot.fk(q0 + 0.01), q0=q0, points=point))
    return method
