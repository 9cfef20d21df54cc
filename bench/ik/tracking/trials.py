"""A moving target among moving spheres at 1 kHz, each step from the last answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.experiment import ARMS
from bench.ik.hard.trials import TOLERANCE, prepared_method
from bench.ik.judges.recheck import UrdfChain, recheck
from bench.ik.methods import Problem
from bench.ik.scenes.objects import SceneError
from bench.ik.success.trials import arm_named

FloatArray = npt.NDArray[np.float64]

PERIOD = 0.001  # [s]
DURATION = 2.0  # of a run [s]
SPEED = 1.0  # of the fastest joint, about [rad/s]
SPHERES = 4
RADIUS = 0.05  # [m]
APPROACH = 0.5  # speed of a sphere towards the arm, and then away from it [m/s]
GAPS = (0.01, 0.03)  # from the arm's hulls where a sphere is closest [m]
LEAST_CLEARANCE = 0.005  # of the known motion, always [m]
JUMP = 0.05  # a joint that moves by more in one step jumps: fifty times its speed [rad]
DRAWS = 2000


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A motion q(t) that reaches every target clear of every sphere, by the built-in hulls."""

    q: FloatArray  # (steps, n) [rad]
    spheres: FloatArray  # (steps, SPHERES, 4): centre and radius [m]


def random_run(robot_name: str, rng: np.random.Generator) -> Run:
    """Sines about a random configuration, spheres that come close to it one after the other."""
    robot = arm_named(robot_name).robot
    judge = pdoik.Solver(robot)
    t = np.arange(0.0, DURATION, PERIOD)
    for _ in range(DRAWS):
        spread = robot.upper - robot.lower
        middle = robot.mid_configuration() + rng.uniform(-0.25, 0.25, robot.dof) * spread
        frequency = rng.uniform(0.1, 0.4, robot.dof)
        phase = rng.uniform(0, 2 * np.pi, robot.dof)
        amplitude = rng.uniform(0.3, 1.0, robot.dof) * SPEED / (2 * np.pi * frequency)
        q = middle + amplitude * np.sin(2 * np.pi * frequency * t[:, None] + phase)
        if (q < robot.lower).any() or (q > robot.upper).any():
            continue
        spheres = _spheres(robot, judge, q, t, rng)
        if spheres is not None:
            return Run(q=q, spheres=spheres)
    raise SceneError(f"tracking: {DRAWS} motions, none of them clear")


def _spheres(
    robot: pdoik.Robot, judge: pdoik.Solver, q: FloatArray, t: FloatArray, rng: np.random.Generator
) -> FloatArray | None:
    """Spheres that come to a point of the arm along a line and leave again, clear all the time."""

    def clearance(k: int, balls: FloatArray) -> float:
        return float(judge.judge(robot.fk(q[k]), q[k], obstacles=balls).clearance)

    tracks: list[FloatArray] = []
    for meeting in np.linspace(0.2, 0.8, SPHERES):
        at = int(meeting * len(t))
        for _ in range(30):
            link, focus, _, other, _ = robot.occupancy.spheroids[
                rng.integers(len(robot.occupancy.spheroids))
            ]
            local = np.add(focus, rng.uniform() * np.subtract(other, focus))
            centre = (robot.fk(q[at], link) @ [*local, 1.0])[:3]
            direction = rng.normal(size=3)
            direction /= np.linalg.norm(direction)
            gap, distance = rng.uniform(*GAPS), 0.15
            for _ in range(40):
                ball = np.array([[*(centre + distance * direction), RADIUS]])
                distance += gap - clearance(at, ball)
            away = distance + APPROACH * np.abs(t - t[at])
            track = np.column_stack([centre + away[:, None] * direction, np.full(len(t), RADIUS)])
            samples = range(0, len(t), 10)
            if all(clearance(k, track[k : k + 1]) > LEAST_CLEARANCE for k in samples):
                tracks.append(track)
                break
        else:
            return None
    return np.stack(tracks, axis=1)


def run_method(job: Mapping[str, Any]) -> list[dict[str, Any]]:
    """One run by every method of the job: robot, index, seed, methods, max_time, libraries."""
    arm = arm_named(job["robot"])
    seed = [job["seed"], ARMS.index(arm.name), job["index"]]
    run = random_run(arm.name, np.random.default_rng(seed))
    chain = UrdfChain(arm.urdf, arm.robot.joint_names)
    options = pdoik.Options(
        position_tolerance=TOLERANCE, rotation_tolerance=TOLERANCE, clearance_tolerance=1e-6
    )
    reference = float(np.abs(np.diff(run.q, axis=0)).max())
    rows = []
    for name in job["methods"]:
        method = prepared_method(name, arm.name, job["max_time"], job["libraries"], 0)
        q, steps, times, solved = run.q[0].copy(), [], [], []
        for target, balls in zip(run.q, run.spheres, strict=True):
            T_base_tip = arm.robot.fk(target)
            problem = Problem(T_base_tip=T_base_tip, q0=q, points=balls)
            answer = method.solve(problem)
            times.append(answer.time)
            verdict = recheck(chain, arm.robot, options, T_base_tip, answer.q, balls)
            solved.append(answer.claimed and verdict.confirms(options))
            if solved[-1]:  # what does not solve the step is not sent to the robot
                steps.append(float(np.abs(answer.q - q).max()))
                q = answer.q
        rows.append(
            {
                "robot": arm.name,
                "index": job["index"],
                "method": name,
                "language": method.language,
                "steps": len(solved),
                "solved": int(np.sum(solved)),
                "reference_step": reference,
                "largest_step": max(steps, default=0.0),
                "jumps": int(np.sum(np.array(steps) > JUMP)),
                "median": float(np.median(times)),
                "p999": float(np.quantile(times, 0.999)),
                "worst": float(np.max(times)),
            }
        )
    return rows
