"""Goals that arms cannot reach: whether they rest, and how much nearer they could have come."""

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.lines import Jobs, Line, millimetres, share
from bench.ik.safety.least import ROTATION_WEIGHT, Errand
from bench.ik.safety.world import (
    ARMS,
    NO_BALLS,
    PERIOD,
    UNHURRIED,
    Box,
    World,
    distances,
    judge_of,
    pose_of,
    robot_of,
)
from bench.ik.soak.judge import Judge
from bench.ik.soak.solves import Row

KINDS = ("wall", "points", "beyond reach", "itself")
SIZES = (12, 108)  # cases
OF_REST = 4  # cases of each kind and arm that show whether they rest
AFTER, UNTIL = 2000, 2500  # steps between which it should rest
REVERSED_FROM = 1700  # step from which reversals count
MOVES = 0.05  # a joint that reverses is at least as fast [rad/s]
RESTS = 1e-3  # a joint that rests is slower [rad/s]
STILL, STEPS = 300, 8000  # steps without motion that end a run, and the most
NO_MOTION = 1e-9  # in a step [rad]
NEAR, NEAR_STARTS = 0.1, 3  # about the start [rad]
STARTS = 64  # anywhere
WORSE = 1e-3  # than the least [m]
CLEAR = 0.002  # of a start [m]


def jobs(size: int, seed: int) -> Jobs:
    """A case each: the kinds and arms by turns."""
    cases = [
        (index, kind, robot) for index, kind, robot in product(range(-(-size // 12)), KINDS, ARMS)
    ]
    return {
        f"{robot}-{kind.replace(' ', '_')}-{index:03d}": {
            "robot": robot,
            "kind": kind,
            "index": index,
            "seed": seed,
        }
        for index, kind, robot in cases[:size]
    }


def draw(judge: Judge, kind: str, rng: np.random.Generator) -> tuple[FloatArray, FloatArray, World]:
    """A start that is clear, a goal that cannot be met, and what is around."""
    lower, upper = judge.kinematics.lower, judge.kinematics.upper
    while True:
        start = 0.25 * (lower + upper) + 0.5 * rng.uniform(lower, upper)
        T = pose_of(judge, start)
        ahead = rng.normal(size=3)
        ahead /= np.linalg.norm(ahead)
        goal, world = T.copy(), World(balls=NO_BALLS)
        if kind == "wall":
            place = np.eye(4)
            place[:3, :3] = _facing(ahead)
            place[:3, 3] = T[:3, 3] + 0.18 * ahead
            world = World(balls=NO_BALLS, boxes=[Box(size=np.array([0.5, 0.5, 0.02]), T=place)])
            goal[:3, 3] += 0.25 * ahead
        elif kind == "points":
            points = T[:3, 3] + 0.17 * ahead + rng.normal(0.0, 0.05, (60, 3))
            world = World(balls=np.c_[points, np.zeros(60)])
            goal[:3, 3] += 0.25 * ahead
        elif kind == "beyond reach":
            goal[:3, 3] = 2.5 * ahead
            goal[2, 3] = abs(goal[2, 3])
        else:
            goal[:3, 3] = np.array([0.0, 0.0, 0.4]) + rng.uniform(-0.05, 0.05, 3)
        if min(map(min, distances(judge, start[None], world))) > CLEAR:
            return start, goal, world


def _facing(z: FloatArray) -> FloatArray:
    x = np.cross(z, [0.3, 0.5, 0.8])
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def walk(name: str, start: FloatArray, goal: FloatArray, world: World) -> FloatArray:
    """Configurations until it rests, (T, n), the start first."""
    options = pdoik.Options(rotation_weight=ROTATION_WEIGHT, self_collision=True)
    tracker = pdoik.Tracker(pdoik.Solver(robot_of(name), options), PERIOD, max_time=UNHURRIED)
    tracker.reset(start)
    Q, still = [start], 0
    while len(Q) <= STEPS and (still < STILL or len(Q) <= UNTIL):
        Q.append(tracker.step(goal, world.given()).q.copy())
        still = still + 1 if np.abs(Q[-1] - Q[-2]).max() < NO_MOTION else 0
    return np.array(Q)


def reversals(Q: FloatArray) -> float:
    """Share of steps in which a joint that moves turns round."""
    v = np.diff(Q, axis=0) / PERIOD
    return float(((v[1:] * v[:-1] < 0.0) & (np.abs(v[1:]) > MOVES)).any(axis=1).mean())


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One case."""
    name = job["robot"]
    key = [job["seed"], 13, ARMS.index(name), KINDS.index(job["kind"]), job["index"]]
    rng = np.random.default_rng(key)
    judge = judge_of(name)
    start, goal, world = draw(judge, job["kind"], rng)
    Q = walk(name, start, goal, world)
    errand = Errand(judge, world, goal)
    lower, upper = judge.kinematics.lower, judge.kinematics.upper
    near = [start, *(start + rng.uniform(-NEAR, NEAR, (NEAR_STARTS, len(start))))]
    crept = [errand.creep(np.clip(q, lower, upper)) for q in near]
    onwards = errand.creep(Q[-1])
    anywhere = rng.uniform(lower, upper, (STARTS, len(start)))
    least, best = errand.least([*anywhere, *(q for _, q in crept), Q[-1]])
    fast = np.abs(np.diff(Q[AFTER : UNTIL + 1], axis=0)).max(axis=1) / PERIOD
    return [
        {
            **{key: job[key] for key in ("robot", "kind", "index")},
            "steps": len(Q) - 1,
            "error": float(errand.errors(Q[[-1]])[0]),
            "onwards": onwards[0],
            "near": min(error for error, _ in crept),
            "least": min(least, onwards[0], *(error for error, _ in crept)),
            "speed": float(fast.max()),
            "speed_then": float(fast[0]),
            "reversed": reversals(Q[REVERSED_FROM : UNTIL + 1]),
            "speed_at_end": float(np.abs(Q[-1] - Q[-2]).max() / PERIOD),
            "gap": float(min(map(min, distances(judge, Q[[-1]], world)))),
            "start": start.tolist(),
            "rest": Q[-1].tolist(),
            "onwards_at": onwards[1].tolist(),
            "best": best.tolist(),
        }
    ]


def lines(trials: pd.DataFrame) -> list[Line]:
    """Lines of rest, and of what is left compared with the least."""
    some = trials[trials["index"] < OF_REST]
    rests = some.speed < RESTS
    kinds = ", ".join(f"{int((some.kind == kind).sum())} {kind}" for kind in KINDS)
    lines = [
        Line(
            what="goal that cannot be met: arms that rest 2 to 2.5 s after the start",
            asked="all",
            measured=f"{int(rests.sum())} of {len(some)}; the fastest {some.speed.max():.3g} rad/s",
            cases=f"{len(some)} ({kinds})",
            failures=int((~rests).sum()),
        ),
        Line(
            what="... steps that reverse, 1.7 to 2.5 s after it",
            asked="0",
            measured=f"{some.reversed.mean():.4f}, at most {some.reversed.max():.3f} of a case",
            cases=f"{len(some)}",
            failures=int((some.reversed > 0.0).sum()),
        ),
    ]
    for column, what in (
        ("onwards", "what is left of such a goal, within 1 mm of where a descent goes on to"),
        ("near", f"... of the best of {NEAR_STARTS + 1} continuous descents from beside the start"),
        ("least", f"... of the least of {STARTS} descents from anywhere"),
    ):
        over = trials.error - trials[column]
        bad = over > WORSE
        of = ", ".join(f"{int(bad[trials.kind == kind].sum())} {kind}" for kind in KINDS)
        lines.append(
            Line(
                what=what,
                asked="0.95" if column != "least" else "none (a local controller)",
                measured=f"{share(~bad, len(trials))}; worst {millimetres(over.max())} mm; "
                f"not: {of}",
                cases=f"{len(trials)}",
                failures=int(bad.sum()),
            )
        )
    return lines
