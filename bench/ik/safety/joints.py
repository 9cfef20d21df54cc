"""Joints that have no reason to move, whole turns too many, and jumps where a wrist is singular."""

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.lines import Jobs, Line, millimetres
from bench.ik.safety.world import PERIOD, UNHURRIED, pose_of, without_hulls
from bench.ik.soak.judge import Asked, Goals, Judge, random_configurations
from bench.ik.soak.robots import RobotSpec, builtin_spec
from bench.ik.soak.solves import Row

KINDS = ("idle", "turns", "wrist")
SIZES = (6, 120)  # cases
IDLE = 1e-9  # a joint that stays moves less in a run [rad]
STEPS = 3000  # of idle joints and turns
PASS = 1500  # steps of a way through a wrist's singularity
JUMP = 0.05  # in one step; the known motion makes a hundredth of it [rad]
HURRY = 100.0  # speed limits that let a joint jump, as shares of its own
TOLERANCE = 1e-5  # [m] and [rad]
PROBES = 20


def jobs(size: int, seed: int) -> Jobs:
    """The kinds by turns."""
    return {
        f"{kind}-{k:03d}": {"kind": kind, "index": k, "seed": seed}
        for k, kind in product(range(-(-size // 3)), KINDS)
    }


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One case."""
    rng = np.random.default_rng([job["seed"], 15, KINDS.index(job["kind"]), job["index"]])
    case = {"idle": idle, "turns": turns, "wrist": wrist}[job["kind"]]
    return [{"kind": job["kind"], "index": job["index"], **case(job["index"], rng)}]


def idle(index: int, rng: np.random.Generator) -> Row:
    """A position for one tip of an H1, or of an arm, that some joints have no part in."""
    name = ("h1", "panda", "ur10", "iiwa14")[index % 4]
    spec = builtin_spec(name)
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    tip = spec.tip_links[-1]
    without = idle_joints(judge, tip, rng)
    start, there = random_configurations(judge.kinematics, 2, rng)
    options = pdoik.Options(self_collision=False)
    tracker = pdoik.Tracker(pdoik.Solver(robot, options), PERIOD, max_time=UNHURRIED)
    tracker.reset(start)
    goal = pdoik.Goal(pose_of(judge, there, tip)[:3, 3], type="position")
    for _ in range(STEPS):
        step = tracker.step({tip: goal})
    moved = np.abs(step.q - start) > IDLE
    return {
        "robot": name,
        "n": int(without.sum()),
        "bad": int((moved & without).sum()),
        "reached": step.position_error < TOLERANCE,
        "most": float(np.abs(step.q - start)[without].max(initial=0.0)),
    }


def idle_joints(judge: Judge, tip: str, rng: np.random.Generator) -> BoolArray:
    """Joints that never move a tip's position, by Pinocchio, (n,)."""
    Q = random_configurations(judge.kinematics, PROBES, rng)
    at = judge.kinematics.link(judge.kinematics.place(Q), tip)[1]
    moves = []
    for i in range(Q.shape[1]):
        turned = Q.copy()
        turned[:, i] += 0.3
        there = judge.kinematics.link(judge.kinematics.place(turned), tip)[1]
        moves.append(np.abs(there - at).max())
    return np.array(moves) < 1e-9


def turns(index: int, rng: np.random.Generator) -> Row:
    """A UR10, or an arm whose joints turn for ever, from anywhere to a pose that can be reached."""
    endless = index % 2 == 1
    spec = six_axes() if endless else without_hulls(builtin_spec("ur10"))
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    lower, upper = judge.kinematics.lower, judge.kinematics.upper
    start = rng.uniform(-np.pi, np.pi, 6)
    tip = spec.tip_links[0] if spec.tip_links else robot.tip_links[0]
    goal = pose_of(judge, rng.uniform(-np.pi, np.pi, 6), tip)
    limits: dict[str, Any] = {"max_speed": np.full(6, np.pi)} if endless else {}
    tracker = pdoik.Tracker(pdoik.Solver(robot), PERIOD, max_time=UNHURRIED, **limits)
    tracker.reset(start)
    for _ in range(STEPS):
        q = tracker.step(goal).q
    nearer = fewer_turns(q, start, lower, upper)
    verdict = judge([Goals(tip=tip, T=goal[None])], q[None], Asked())
    return {
        "robot": "endless" if endless else "ur10",
        "n": 1,
        "bad": int(nearer.any()),
        "reached": bool(verdict.solves(Asked())[0]),
        "most": float(np.abs(q - start).max()),
    }


def fewer_turns(
    q: FloatArray, start: FloatArray, lower: FloatArray, upper: FloatArray
) -> BoolArray:
    """Joints that whole turns, within the limits, would bring nearer to the start."""
    back = q - 2 * np.pi * np.round((q - start) / (2 * np.pi))
    return (np.abs(back - start) < np.abs(q - start) - 1e-6) & (lower <= back) & (back <= upper)


def six_axes() -> RobotSpec:
    """An arm of six joints without limits, whose last three axes meet."""
    half = np.pi / 2
    table = (
        (0.0, 0.0, 0.3),
        (half, 0.0, 0.0),
        (0.0, 0.45, 0.0),
        (half, 0.0, 0.4),
        (-half, 0.0, 0.0),
        (half, 0.0, 0.1),
    )
    rows = [
        {
            **dict(zip(("alpha", "a", "d"), each, strict=True)),
            **{"theta_offset": 0.0, "prismatic": False, "lower": -np.inf, "upper": np.inf},
        }
        for each in table
    ]
    return RobotSpec(rows=rows, tip_links=["tool"])


def wrist(index: int, rng: np.random.Generator) -> Row:
    """Along a known motion that goes through, or close by, a wrist's singularity."""
    name = ("ur10", "iiwa14", "six axes")[index % 3]
    spec = six_axes() if name == "six axes" else without_hulls(builtin_spec(name))
    robot = spec.make()
    judge = Judge(spec, robot.joint_names)
    n = len(robot.joint_names)
    singular = n - 2  # the joint at which, at 0, its neighbours' axes are one
    lower = np.maximum(judge.kinematics.lower, -np.pi)
    upper = np.minimum(judge.kinematics.upper, np.pi)
    middle = 0.25 * (lower + upper) + 0.5 * rng.uniform(lower, upper)
    size = rng.uniform(0.05, 0.3, n)
    t = np.linspace(-1.0, 1.0, PASS)[:, None]
    path = middle + size * np.sin(rng.uniform(1.0, 2.0, n) * t + rng.uniform(0, 6, n))
    near = 0.0 if rng.random() < 0.5 else rng.normal() * 0.01
    path[:, singular] = near + 0.3 * t[:, 0]
    R, p = judge.kinematics.link(judge.kinematics.place(path), spec.tip_links[0])
    T = np.tile(np.eye(4), (PASS, 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, p
    hurry = 1.0 if name == "six axes" else HURRY  # whose joints have no limits
    tracker = pdoik.Tracker(pdoik.Solver(robot), PERIOD, max_time=UNHURRIED, speed_share=hurry)
    tracker.reset(path[0])
    Q = np.array([path[0], *(tracker.step(target).q for target in T)])
    goals = Goals(tip=spec.tip_links[0], T=T)
    verdicts = judge([goals], Q[1:], Asked())
    most = np.abs(np.diff(Q, axis=0)).max(axis=1)
    return {
        "robot": name,
        "n": PASS,
        "bad": int((most > JUMP).sum()),
        "reached": bool(verdicts.solves(Asked()).all()),
        "most": float(most.max()),
        "lag": float(verdicts.position_error.max()),
        "turned": float(verdicts.rotation_error.max()),
        "late": int((~verdicts.solves(Asked())).sum()),
        "known": float(np.abs(np.diff(path, axis=0)).max()),
    }


def lines(trials: pd.DataFrame) -> list[Line]:
    """One for each kind."""
    found = []
    still = trials[trials.kind == "idle"]
    if len(still):
        bad = int(still.bad.sum())
        found.append(
            Line(
                what="joints moved that have no part in the goal (H1, three arms)",
                asked="0",
                measured=f"{bad} of {int(still.n.sum())}, at most {still.most.max():.2g} rad",
                cases=f"{len(still)} runs",
                failures=int((still.bad > 0).sum()),
            )
        )
    round_ = trials[(trials.kind == "turns")]
    if len(round_):
        reached = round_[round_.reached]
        found.append(
            Line(
                what="poses reached with whole turns too many (UR10, an arm without limits)",
                asked="0",
                measured=f"{int(reached.bad.sum())} of {len(reached)} reached; "
                f"a joint went {reached.most.max():.2f} rad at most",
                cases=f"{len(round_)} runs",
                failures=int(reached.bad.sum()),
            )
        )
    through = trials[trials.kind == "wrist"]
    if len(through):
        found.append(
            Line(
                what=f"ways through a singular wrist: steps of more than {JUMP:g} rad",
                asked="0",
                measured=f"{int(through.bad.sum())} of {int(through.n.sum()):,}, at most "
                f"{through.most.max():.3f} rad ({through.known.max():.4f} known); "
                f"behind by {millimetres(through.lag.max())} mm, "
                f"{millimetres(through.turned.max())} mrad, beyond tolerance in "
                f"{int(through.late.sum())} steps",
                cases=f"{len(through)} runs",
                failures=int((through.bad > 0).sum()),
            )
        )
    return found
