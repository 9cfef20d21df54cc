"""Runs a Tracker, judges every step, counts, and keeps what failed."""

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.soak.cases import KEPT, encode
from bench.ik.soak.judge import ROUNDING, Asked, Goals, Judge, Verdicts
from bench.ik.soak.motions import SHARES, SPEEDS, STEPS, Motion, Step, draw_motion, step_bounds
from bench.ik.soak.scenes import four_columns, make_goal, make_options
from bench.ik.soak.solves import FIELDS, Row, misreported
from bench.ik.soak.trees import draw_robot

LOOK = 0.5  # a tracker does not measure clearance beyond this [m]
BOUND_ROUNDING = 1e-12  # of a step's bound [rad] or [m]
LONG = 0.02  # a step on which a hull may get farther is looked at on its way as well [m]
EVERY = 0.005  # how far it gets between two looks [m]
LOOKS = 400  # at one step, at most
PAIRS = 5_000_000  # of a hull and a point that are looked at on the way in one run, about
KINEMATICS = 1000  # pairs that could be looked at in the time of one placement, about
PASSING = 0.005  # how deep a hull may be on the way beyond what it is at both ends [m]
FAST, SLOW = 100.0, 0.1  # speed limits are huge above, tiny below [rad/s] or [m/s]
RUNS = 4  # of one robot before the next one is drawn
PREEMPTED = 1e-4  # wall time that the thread did not have [s]
WINDOWS = (1, 5, 25, STEPS)  # steps that a case is tried with, the fewest first
FAULTS = (
    *("false claim", "deeper", "passed through", "limits", "step", "too hard"),
    *("not finite", "not held", "refused", "misreported"),
)
KEPT_OF_MOTION = ("speeds", "options", "tracker", "start", "posture", "goals")
STATUSES = ("tracking", "infeasible", "deadline_struck", "invalid_input")


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """What a run's steps gave, each (T,) but q (T, n)."""

    q: FloatArray
    last: FloatArray  # (T, n)
    status: npt.NDArray[np.str_]
    stopped_hard: BoolArray
    said: dict[str, FloatArray]  # by FIELDS
    time: FloatArray  # as the tracker says [s]
    wall: FloatArray  # of the call [s]
    cpu: FloatArray  # of the thread during the call [s]
    late_evaluations: FloatArray


def run(motion: Motion, robot: pdoik.Robot) -> Record:
    """All steps of a motion."""
    tracker = pdoik.Tracker(pdoik.Solver(robot, make_options(motion.options)), **motion.tracker)
    tracker.reset(motion.start)
    if motion.posture is not None:
        tracker.set_posture(motion.posture)
    kinds = {goal.tip: goal for goal in motion.goals}
    wanted = motion.options["goal"]
    plain = all(not goal.has_slack and goal.type == wanted for goal in motion.goals)
    last, results, clocks = [], [], []
    for step in motion.steps:
        last.append(tracker.q.copy())
        goals: Any = step.goals
        if step.sound and not plain:
            goals = {tip: make_goal(kinds[tip], T) for tip, T in step.goals.items()}
        given = () if step.cloud is None else (step.cloud,)  # else those of the step before
        wall, cpu = time.perf_counter(), time.thread_time()
        results.append(tracker.step(goals, *given))
        clocks.append((time.perf_counter() - wall, time.thread_time() - cpu))

    def of(name: str) -> Any:
        return np.array([getattr(result, name) for result in results])

    wall_times, cpu_times = np.array(clocks).T
    return Record(
        q=of("q"),
        last=np.array(last),
        status=of("tracking"),
        stopped_hard=of("stopped_hard"),
        said={name: of(name) for name in FIELDS},
        time=of("time"),
        wall=wall_times,
        cpu=cpu_times,
        late_evaluations=of("late_evaluations"),
    )


def counted_clouds(steps: Sequence[Step]) -> tuple[list[FloatArray], BoolArray]:
    """The obstacles that count at each step, (N, 4), and whether its input makes sense."""
    now, is_sound = np.zeros((0, 4)), True
    clouds, sound = [], []
    for step in steps:
        if step.cloud is not None:
            is_sound = step.sound_cloud
            if is_sound:
                given = four_columns(step.cloud)
                assert given is not None
                now = given
        clouds.append(now)
        sound.append(is_sound and step.sound)
    return clouds, np.array(sound)


def verdicts_of(
    judge: Judge, goals: Sequence[Goals], Q: FloatArray, asked: Asked, clouds: list[FloatArray]
) -> Verdicts:
    """The judge's figures of all steps; those with one cloud, or clouds of one size, together."""
    parts, first = [], 0
    while first < len(Q):
        last = first + 1
        same = last < len(Q) and clouds[last] is clouds[first]
        while last < len(Q) and (
            clouds[last] is clouds[first] if same else len(clouds[last]) == len(clouds[first])
        ):
            last += 1
        some = slice(first, last)
        points = clouds[first] if same else np.stack(clouds[some])
        parts.append(judge([goal[some] for goal in goals], Q[some], asked, points))
        first = last
    return Verdicts(
        **{name: np.concatenate([getattr(p, name) for p in parts]) for name in Verdicts.__slots__}
    )


def passing_depth(
    judge: Judge, asked: Asked, record: Record, clouds: list[FloatArray], ks: Sequence[int]
) -> dict[int, float]:
    """Excess depth of hulls on the straight way, by step: over its ends and what is allowed [m].

    The way is that of the joints, each at its own steady speed. Of all steps `ks` as many are
    looked at as can be afforded, in this order.
    """
    depth: dict[int, float] = {}
    counted = len(judge.A) if asked.base_collision else int((~judge.fixed).sum())
    pairs = 0
    for k in ks:
        moved = record.q[k] - record.last[k]
        looks = int(np.clip(np.ceil(judge.travel(moved[None])[0] / EVERY), 2, LOOKS))
        pairs += looks * (KINEMATICS + len(clouds[k]) * counted)
        if pairs > PAIRS and depth:
            break
        way = record.last[k] + np.linspace(0.0, 1.0, looks + 1)[:, None] * moved
        a, b = judge.hulls(judge.kinematics.place(way))
        gaps = judge.clearance(a, b, clouds[k], asked)
        allowed = min(gaps[0], gaps[-1], asked.clearance - asked.clearance_tolerance)
        depth[int(k)] = max(0.0, float(allowed - gaps.min()))
    return depth


def deeper(verdicts: Verdicts, held: Verdicts, asked: Asked) -> FloatArray:
    """How much deeper steps are in anything than standing still, and than contact, (T,) [m]."""
    pairs = (
        (verdicts.clearance, held.clearance, asked.clearance),
        (verdicts.self_distance, held.self_distance, asked.self_clearance),
        (-verdicts.balance_violation, -held.balance_violation, 0.0),
    )
    return np.max([np.minimum(still, wanted) - now for now, still, wanted in pairs], axis=0)


def too_hard(tracker: Mapping[str, Any], record: Record) -> BoolArray:
    """Which steps change a joint's speed by more than is allowed and do not say so, (T,)."""
    most = tracker.get("max_acceleration")
    if most is None:
        return np.zeros(len(record.q), bool)
    period = tracker["period"]
    speed = (record.q - record.last) / period
    change = np.abs(np.diff(speed, axis=0, prepend=0.0 * speed[:1]))
    beyond = (change > period * most + BOUND_ROUNDING / period).any(axis=1)
    return np.asarray(beyond & ~record.stopped_hard)


def speed_class(speeds: FloatArray) -> str:
    """Class of the limits that hold, in the words of SPEEDS."""
    if np.isinf(speeds).any():
        return "none"
    return "huge" if speeds.max() > FAST else "tiny" if speeds.max() < SLOW else "usual"


def examine(motion: Motion, judge: Judge, record: Record) -> tuple[Row, dict[str, BoolArray]]:
    """Worst figures of a run, and which steps have which faults."""
    asked = Asked.of(motion.options)
    clouds, sound = counted_clouds(motion.steps)
    verdicts = verdicts_of(judge, motion.goals, record.q, asked, clouds)
    held = verdicts_of(judge, motion.goals, record.last, asked, clouds)
    beyond = deeper(verdicts, held, asked)
    tracks = record.status == "tracking"
    refused = record.status == "invalid_input"
    moved = np.abs(record.q - record.last)
    bound = step_bounds(motion.tracker, judge.kinematics.velocity)
    over = (moved - bound).max(axis=1)
    found = {
        "false claim": tracks & ~verdicts.solves(asked),
        "deeper": beyond > ROUNDING,
        "limits": ~verdicts.limits_hold,
        "step": over > BOUND_ROUNDING,
        "too hard": too_hard(motion.tracker, record),
        "not finite": ~np.isfinite(record.q).all(axis=1),
        "not held": ~sound & ~(refused & (record.q == record.last).all(axis=1)),
        "refused": sound & refused,
        "misreported": sound & ~refused & misreported(record.said, verdicts, asked, LOOK),
    }
    crowded = np.array([len(cloud) > 0 for cloud in clouds]) & (len(judge.A) > 0)
    is_long = crowded & (judge.travel(record.q - record.last) > LONG)
    shuffled = np.random.default_rng(0).permutation(len(tracks))
    depth, depth_else = (
        passing_depth(judge, asked, record, clouds, [k for k in shuffled if is_long[k] & those[k]])
        for those in (tracks, ~tracks)
    )
    found["passed through"] = np.array([depth.get(k, 0.0) > PASSING for k in range(len(tracks))])
    deadline = motion.tracker.get("max_time", 0.8 * motion.tracker["period"])
    late = record.time - deadline
    clearance_left = verdicts.clearance - (asked.clearance - asked.clearance_tolerance)
    row = {
        "n": len(tracks),
        **{name: int((record.status == name).sum()) for name in STATUSES},
        **{f"fault {name}": int(found[name].sum()) for name in FAULTS},
        "speeds": speed_class(bound / motion.tracker["period"]),
        "long": int((is_long & tracks).sum()),
        "looked_at": len(depth),
        "deeper": float(beyond.max()),
        "least_clearance_left": float(clearance_left[tracks].min(initial=np.inf)),
        "step_over": float(np.nanmax(np.where(np.isfinite(over), over, -np.inf), initial=-np.inf)),
        "path_depth": max(depth.values(), default=0.0),
        "path_depth_else": max(depth_else.values(), default=0.0),
        "overrun": float(late.max()),
        # The thread had no more in the step than in the call, nor more than the step took.
        "overrun_cpu": float((np.minimum(record.time, record.cpu) - deadline).max()),
        "late": int((late > 0.0).sum()),
        "preempted": int(((late > 0.0) & (record.wall - record.cpu > PREEMPTED)).sum()),
        "late_evaluations": int(record.late_evaluations.max()),
        **verdicts.worst(asked, tracks),
    }
    return row, found


def case_of(
    motion: Motion, robot: pdoik.Robot, judge: Judge, record: Record, k: int, fault: str
) -> dict[str, Any]:
    """What `replay` needs: as few steps up to the k-th as show the fault again."""
    clouds, _ = counted_clouds(motion.steps)
    for window in WINDOWS:
        first = max(0, k + 1 - window)
        cloud = clouds[first] if len(clouds[first]) else None
        part = motion.part(first, k + 1, record.last[first], cloud)
        shown = bool(examine(part, judge, run(part, robot))[1][fault][-1])
        if shown or first == 0:
            break
    return {
        "kind": "tracking",
        "complaints": [fault],
        "shown_again": shown,
        "robot": motion.spec,
        **{name: getattr(part, name) for name in KEPT_OF_MOTION},
        "steps": [{name: getattr(step, name) for name in Step.__slots__} for step in part.steps],
    }


def replay(case: Mapping[str, Any]) -> list[str]:
    """Run the steps again; the faults of any of them."""
    spec = case["robot"]
    robot = spec.make()
    steps = [Step(**step) for step in case["steps"]]
    motion = Motion(spec=spec, steps=steps, **{name: case[name] for name in KEPT_OF_MOTION})
    _, found = examine(motion, Judge(spec, robot.joint_names), run(motion, robot))
    return [name for name in FAULTS if found[name].any()]


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """Runs of one family until the job's number of steps is there."""
    rng = np.random.default_rng([job["seed"], 2, *job["key"]])
    rows: list[Row] = []
    left, kept = job["count"], 0
    while left > 0:
        if len(rows) % RUNS == 0:
            speeds = str(rng.choice(SPEEDS, p=SHARES))
            robot_speeds = speeds if speeds in ("none", "huge") else "usual"
            spec = draw_robot(job["family"], rng, robot_speeds)
            robot = spec.make()
            judge = Judge(spec, robot.joint_names)
        clocks = [time.thread_time()]
        motion = draw_motion(judge, speeds, rng, min(STEPS, left))
        clocks.append(time.thread_time())
        record = run(motion, robot)
        clocks.append(time.thread_time())
        row, found = examine(motion, judge, record)
        clocks.append(time.thread_time())
        names = ("draw_seconds", "run_seconds", "judge_seconds")
        seconds = dict(zip(names, np.diff(clocks).tolist(), strict=True))
        failed = [(fault, int(k)) for fault in FAULTS for k in np.flatnonzero(found[fault])[:2]]
        cases = {
            f"tracking-{job['name']}-{len(rows):04d}-{k:04d}-{fault.replace(' ', '_')}": case_of(
                motion, robot, judge, record, k, fault
            )
            for fault, k in failed[: KEPT - kept]
        }
        kept += len(cases)
        text = json.dumps(encode(cases)) if cases else ""
        about = {"family": job["family"], "run": len(rows), "cases": text}
        rows.append({**about, **row, **seconds})
        left -= row["n"]
    return rows
