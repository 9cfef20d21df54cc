"""Hard scenes, problem by problem: every method gets the same ones."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

import pdoik
from bench.ik.experiment import ARMS
from bench.ik.hard.scenes import FAMILIES, HardProblem, Maker
from bench.ik.judges.recheck import recheck
from bench.ik.methods import Method, Problem, Terms
from bench.ik.scenes.around import arm_named, chain_of, mesh_judge, models_of, prepared_method

TOLERANCE = 1e-4  # [m] and [rad]
ROUNDING = 1e-6  # by which an answer may touch the hulls [m]
OPTIONS = pdoik.Options(
    position_tolerance=TOLERANCE, rotation_tolerance=TOLERANCE, clearance_tolerance=ROUNDING
)


def terms_of(max_time: float, seed: int = 0) -> Terms:
    """Whole poses."""
    return Terms(
        goal="pose",
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        max_time=max_time,
        seed=seed,
    )


def run_block(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The trials of some consecutive problems of one family and arm.

    Args:
        job: robot, family, first, count, seed, ycb, max_time, libraries; and methods, a list of
            (name, number of problems that it takes part in). Each is solved with `repeats` seeds.
    """
    robot, family = job["robot"], job["family"]
    maker, base = _maker(robot, job["ycb"]), [ARMS.index(robot), list(FAMILIES).index(family)]
    problems = [
        FAMILIES[family](maker, np.random.default_rng([job["seed"], *base, index]))
        for index in range(job["first"], job["first"] + job["count"])
    ]
    rows = []
    for seed in range(job["repeats"]):
        for name, count in job["methods"]:
            method = prepared_method(name, robot, terms_of(job["max_time"], seed), job["libraries"])
            for index, problem in enumerate(problems, start=job["first"]):
                if index < count:
                    outcome = solve_and_judge(maker, method, problem, job["max_time"])
                    head = {"robot": robot, "family": family, "index": index}
                    rows.append({**head, "method": name, "repeat": seed, **outcome})
    return rows


def solve_and_judge(
    maker: Maker, method: Method, problem: HardProblem, max_time: float
) -> dict[str, Any]:
    """One method's answer to one problem, judged by NumPy from the URDF and, on meshes, by coal."""
    robot, T, points = maker.arm.robot, problem.T_base_tip, problem.points
    answer = method.solve(Problem(T, robot.mid_configuration(), points, near_q0=False))
    verdict = recheck(chain_of(maker.arm.name), robot, OPTIONS, T, answer.q, points)
    collision = maker.judge.collision(answer.q, problem.bodies) if problem.bodies else None
    confirmed = verdict.confirms(OPTIONS) and answer.time <= max_time
    return {
        "language": method.language,
        "n_points": len(points),
        **answer.row(),
        "confirmed": confirmed,
        "solved": answer.claimed and confirmed,
        "mesh_collision": collision or "",
        "position_error": verdict.position_error,
        "rotation_error": verdict.rotation_error,
        "limit_violation": verdict.limit_violation,
        "clearance": verdict.clearance,
    }


@cache
def _maker(robot: str, ycb: str | None) -> Maker:
    return Maker(arm_named(robot), mesh_judge(robot), models_of(ycb))
