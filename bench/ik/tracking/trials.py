"""A moving target among moving spheres at 1 kHz, each step from the last answer."""

from collections.abc import Mapping
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import ARMS
from bench.ik.hard.trials import OPTIONS, terms_of
from bench.ik.judges.recheck import recheck
from bench.ik.methods import Problem
from bench.ik.scenes.around import arm_named, chain_of, prepared_method
from bench.ik.scenes.objects import SceneError

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


def random_run(robot_name: str, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Sines about a random configuration, spheres that come close to it one after the other.

    The motion q, (steps, n) [rad], reaches every target clear of every sphere, by the built-in
    hulls. The spheres are centres and radii, (steps, SPHERES, 4) [m].
    """
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
        spheres = _spheres(judge, q, t, rng)
        if spheres is not None:
            return q, spheres
    raise SceneError(f"tracking: {DRAWS} motions, none of them clear")


def _spheres(
    judge: pdoik.Solver, q: FloatArray, t: FloatArray, rng: np.random.Generator
) -> FloatArray | None:
    """Spheres that come to a point of the arm along a line and leave again, clear all the time."""
    robot = judge.robot
    spheroids = robot.occupancy.spheroids

    def clearance(k: int, balls: FloatArray) -> float:
        return float(judge.judge(robot.fk(q[k]), q[k], obstacles=balls).clearance)

    tracks: list[FloatArray] = []
    for meeting in np.linspace(0.2, 0.8, SPHERES):
        at = int(meeting * len(t))
        for _ in range(30):
            link, focus, _, other, _ = spheroids[rng.integers(len(spheroids))]
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
    """One run by every method of the job: robot, first, seed, methods, max_time, libraries.

    The methods are pairs of a name and the number of runs that it takes part in.
    """
    name, index = job["robot"], job["first"]
    robot, chain = arm_named(name).robot, chain_of(name)
    motion, spheres = random_run(
        name, np.random.default_rng([job["seed"], ARMS.index(name), index])
    )
    rows = []
    for method_name, count in job["methods"]:
        if index >= count:
            continue
        method = prepared_method(method_name, name, terms_of(job["max_time"]), job["libraries"])
        q, steps, times, solved = motion[0].copy(), [], [], 0
        for target, balls in zip(motion, spheres, strict=True):
            T_base_tip = robot.fk(target)
            answer = method.solve(Problem(T_base_tip, q, balls))
            times.append(answer.time)
            verdict = recheck(chain, robot, OPTIONS, T_base_tip, answer.q, balls)
            if answer.claimed and verdict.confirms(OPTIONS):
                solved += 1  # what does not solve the step is not sent to the robot
                steps.append(float(np.abs(answer.q - q).max()))
                q = answer.q
        rows.append(
            {
                "robot": name,
                "index": index,
                "method": method_name,
                "language": method.language,
                "steps": len(times),
                "solved": solved,
                "reference_step": float(np.abs(np.diff(motion, axis=0)).max()),
                "largest_step": max(steps, default=0.0),
                "jumps": int(np.sum(np.array(steps) > JUMP)),
                "median": float(np.median(times)),
                "p999": float(np.quantile(times, 0.999)),
                "worst": float(np.max(times)),
            }
        )
    return rows
