"""Poses that five joints cannot meet: the position held, the orientation as near as can be.

Compared with the best of 50 descents of SciPy's SLSQP over all joints inside their limits, the
position an equation, each from a random configuration that meets it.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import FloatArray
from bench.common.intervals import duration
from bench.ik.goals.world import POSITION, angle, interbotix, model_file, quantiles
from bench.ik.lines import Line, jobs_of, share
from bench.ik.soak.solves import Row

SIZES = (1, 100)  # jobs
POSES = 10  # each
STARTS = 50
NEAR = 0.01  # share of the least error that one may have more
ROBOTS = ("SO-101", "WX250")


jobs = partial(jobs_of, robot=ROBOTS)


def description(name: str) -> str:
    """An arm's URDF, by name."""
    if name == "WX250":
        return interbotix("wx250")
    return pdoik.urdf_text(model_file("so101_robot_model/so101.urdf"))


def arm(name: str) -> pdoik.Robot:
    """The arm of this name."""
    tip = "/ee_gripper_link" if name == "WX250" else "gripper_frame_link"
    return pdoik.Robot.from_urdf(description(name), tip_link=tip)


def bounds(robot: pdoik.Robot) -> tuple[FloatArray, FloatArray]:
    """Limits of its joints, (n,) each; a whole turn where there are none."""
    return (
        np.where(np.isfinite(robot.lower), robot.lower, -np.pi),
        np.where(np.isfinite(robot.upper), robot.upper, np.pi),
    )


def any_turn_at_a_place(robot: pdoik.Robot, rng: np.random.Generator) -> FloatArray:
    """A place that it reaches with an orientation that it most likely does not, (4, 4)."""
    T = robot.fk(rng.uniform(*bounds(robot)))
    T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    return T


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One call of ours compared with fifty descents."""
    rng = np.random.default_rng([job["seed"], 4, job["index"], ROBOTS.index(job["robot"])])
    robot = arm(job["robot"])
    solver = pdoik.Solver(robot, pdoik.Options(max_time=0.01))
    rows = []
    for _ in range(POSES):
        T = any_turn_at_a_place(robot, rng)
        result = solver.solve(T, priority="position")
        at = robot.fk(result.q)
        turned = angle(at[:3, :3].T @ T[:3, :3])
        least = best(robot, solver, T, rng)
        rows.append(
            {
                "robot": job["robot"],
                "status": result.status,
                "error": turned,
                "least": least,
                "wrong": bool(
                    result.status == "nearest"
                    and (
                        np.linalg.norm(at[:3, 3] - T[:3, 3]) > POSITION + 1e-9
                        or abs(turned - result.rotation_error) > 1e-6
                    )
                ),
                "time": result.time,
            }
        )
    return rows


def best(
    robot: pdoik.Robot, solver: pdoik.Solver, T: FloatArray, rng: np.random.Generator
) -> float:
    """The least error of 50 descents [rad]."""
    lower, upper = bounds(robot)

    def cost(q: FloatArray) -> float:
        return 0.5 * angle(robot.fk(q)[:3, :3].T @ T[:3, :3]) ** 2

    equation = {"type": "eq", "fun": lambda q: robot.fk(q)[:3, 3] - T[:3, 3]}
    least = np.inf
    for _ in range(STARTS):
        start = solver.solve(pdoik.Goal(T, type="position"), q0=rng.uniform(lower, upper))
        if not start.success:
            continue
        end = minimize(
            cost,
            start.q,
            method="SLSQP",
            bounds=list(zip(lower, upper, strict=True)),
            constraints=equation,
            options={"maxiter": 100, "ftol": 1e-10},
        )
        if np.linalg.norm(robot.fk(end.x)[:3, 3] - T[:3, 3]) < POSITION:
            least = min(least, float(np.sqrt(2 * end.fun)))
    return least


def lines(trials: pd.DataFrame) -> list[Line]:
    """How often it is within a hundredth of the best."""
    found = []
    for name in ROBOTS:
        some = trials[(trials.robot == name) & np.isfinite(trials.least)]
        if some.empty:
            continue
        excess = some.error / some.least - 1
        median, worst = quantiles(some.time.to_numpy())
        found.append(
            Line(
                what=f"{name}, position first: error within 1 % of the best of {STARTS} descents",
                asked="0.990; no local optimum 0.950; 1 ms",
                measured=f"{share(excess <= NEAR, len(some))}, worst {100 * excess.max():.1f} % "
                f"more; median {duration(median)} (99 %: {duration(worst)})",
                cases=f"{len(some):,} poses",
                failures=int(some.wrong.sum()),
            )
        )
    return found
