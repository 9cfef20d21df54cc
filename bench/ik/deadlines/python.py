"""Calls with a deadline as Python makes them: the Panda, the default method, random targets."""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

import pdoik

CALL = "LM, from Python"
WARM_UP = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """How much is measured, and on which goals."""

    repeats: int  # calls of each kind of goal
    seconds: float  # for each at most
    seed: int


def python_calls(
    cloud: Path | None, budget: float, intake_cpu: float, effort: Effort
) -> pd.DataFrame:
    """As `calls_of` of deadlines gives them, among a file of doubles, x y z row by row.

    The budget of a solve and the cloud's intake by the thread's clock are in [s].
    """
    robot = pdoik.Robot.builtin("panda")
    points = np.empty((0, 3)) if cloud is None else np.fromfile(cloud).reshape(-1, 3)
    solver = pdoik.Solver(
        robot, pdoik.Options(max_time=budget, base_collision=False, self_collision=False)
    )
    rng = np.random.default_rng(effort.seed)
    until, rows = time.monotonic() + effort.seconds, []
    for turn in range(-WARM_UP, effort.repeats):
        T_base_tip = robot.fk(rng.uniform(robot.lower, robot.upper))
        wall, cpu = time.perf_counter_ns(), time.thread_time_ns()
        result = solver.solve(T_base_tip, obstacles=points)
        cpu, wall = time.thread_time_ns() - cpu, time.perf_counter_ns() - wall
        if turn >= 0:
            spent = 1e-9 * wall - result.intake
            rows.append(
                {
                    "intake": result.intake,
                    "intake_cpu": intake_cpu,
                    "wall": spent,
                    "cpu": 1e-9 * cpu - intake_cpu,
                    "late": result.late_evaluations,
                    "evaluations": result.evaluations,
                    "struck": result.status == "time_limit" or spent >= budget,
                }
            )
        if turn > 0 and time.monotonic() > until:
            break
    return pd.DataFrame(rows)
