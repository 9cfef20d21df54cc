"""What a Tracker is put through: moving targets and obstacles, any speed limits, rubbish."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.soak.judge import Goals, Judge, random_configurations
from bench.ik.soak.robots import RobotSpec
from bench.ik.soak.scenes import draw_cloud, draw_goals, draw_options, four_columns
from bench.ik.soak.trees import HUGE

STEPS = 250  # of a run
SPEEDS = ("usual", "none", "huge", "tiny")
SHARES = (0.45, 0.25, 0.2, 0.1)
MOST_POINTS = 3000  # Options.max_obstacles
NONE = np.zeros((0, 4))


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One call of Tracker.step, and what it is worth."""

    goals: dict[str, FloatArray]  # by tip, (4, 4): as they are given, sense or not
    cloud: FloatArray | None  # as it is given; None for that of the step before
    sound: bool = True  # whether the goals make sense
    sound_cloud: bool = True  # whether the cloud does


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """A tracker and its inputs."""

    spec: RobotSpec
    speeds: str  # of SPEEDS
    options: dict[str, Any]
    tracker: dict[str, Any]  # arguments of pdoik.Tracker
    start: FloatArray  # (n,)
    posture: FloatArray | None  # (n,)
    goals: list[Goals]  # of the steps, before any of them was spoilt; the type and slack of all
    steps: list[Step]

    def part(self, first: int, last: int, start: FloatArray, cloud: FloatArray | None) -> Self:
        """Steps first to last - 1, beginning at a configuration with a cloud."""
        steps = list(self.steps[first:last])
        if steps[0].cloud is None and cloud is not None:
            steps[0] = replace(steps[0], cloud=cloud, sound_cloud=True)
        goals = [goal[first:last] for goal in self.goals]
        return replace(self, start=start, goals=goals, steps=steps)


def draw_motion(judge: Judge, speeds: str, rng: np.random.Generator, count: int) -> Motion:
    """A run of `count` steps."""
    kinematics = judge.kinematics
    start = random_configurations(kinematics, 1, rng)[0]
    options = draw_options(judge, rng, about=start)
    for name in ("method", "inner", "max_restarts", "max_time"):
        options.pop(name, None)
    options["max_obstacles"] = MOST_POINTS
    if options["self_collision"]:
        own = judge.self_distance(*judge.hulls(kinematics.place(start[None])))[0]
        options["self_collision"] = bool(own > options["self_clearance"])
    tracker = _tracker(kinematics.velocity, speeds, rng)
    path = _path(judge, start, step_bounds(tracker, kinematics.velocity), count, rng)
    goals = draw_goals(judge, path, options, rng, slack=bool(rng.random() < 0.5), astray=False)
    if rng.random() < 0.15:
        beyond = rng.random(count) < 0.1
        goals[0].T[beyond, :3, 3] += rng.uniform(-3.0, 3.0, 3)
    clouds = _clouds(judge, start, options["clearance"], count, rng)
    steps = [
        Step(goals={goal.tip: goal.T[k] for goal in goals}, cloud=cloud)
        for k, cloud in enumerate(clouds)
    ]
    if rng.random() < 0.2:
        steps = _spoil(steps, rng)
    posture = random_configurations(kinematics, 1, rng)[0] if rng.random() < 0.3 else None
    return Motion(
        spec=kinematics.spec,
        speeds=speeds,
        options=options,
        tracker=tracker,
        start=start,
        posture=posture,
        goals=goals,
        steps=steps,
    )


def step_bounds(tracker: Mapping[str, Any], velocity: FloatArray) -> FloatArray:
    """Bounds of each joint's step, (n,) [rad] or [m]."""
    speed = tracker["speed_share"] * velocity
    if tracker.get("max_speed") is not None:
        speed = np.minimum(speed, tracker["max_speed"])
    return np.asarray(tracker["period"] * speed)


def _tracker(velocity: FloatArray, speeds: str, rng: np.random.Generator) -> dict[str, Any]:
    period = float(rng.choice([1e-3, 4e-3, 1e-2]))
    tracker: dict[str, Any] = {"period": period, "speed_share": float(rng.choice([1.0, 0.5, 2.0]))}
    if speeds == "huge":
        tracker["speed_share"] = float(10 ** rng.uniform(*np.log10(HUGE)))
    elif speeds == "tiny":
        tracker["max_speed"] = 10 ** rng.uniform(-6, -1, len(velocity))
        tracker["max_speed"][rng.random(len(velocity)) < 0.1] = 0.0
    elif speeds == "usual" and rng.random() < 0.3:
        tracker["max_speed"] = rng.uniform(0.1, 5.0, len(velocity))
    if rng.random() < 0.25:
        tracker["max_acceleration"] = 10 ** rng.uniform(0.0, 2.0, len(velocity))
    if rng.random() < 0.4:
        tracker["max_time"] = float(10 ** rng.uniform(-5, -3))
    return tracker


def _path(
    judge: Judge, start: FloatArray, step: FloatArray, count: int, rng: np.random.Generator
) -> FloatArray:
    """Configurations whose tips are the targets: a smooth path, jumps, or both, (count, n)."""
    kinematics = judge.kinematics
    ahead = np.minimum(step, 0.02)
    k = np.arange(count)[:, None]
    turns = rng.uniform(0.5, 3.0, len(start)) * 2 * np.pi / count
    pace = rng.uniform(0.2, 1.5) * ahead
    phase = rng.uniform(0, 6, len(start))
    path = start + pace / turns * (np.sin(turns * k + phase) - np.sin(phase))
    draw = 2.0 * rng.random()
    if draw < 0.9:
        many = random_configurations(kinematics, 12, rng)
        near = start + rng.uniform(-1.0, 1.0, many.shape) * rng.uniform(0.05, 1.0)
        places = near if rng.random() < 0.5 else many
        held = places[np.minimum(k[:, 0] * len(places) // count, len(places) - 1)]
        path = held if draw < 0.5 else path + (held - start) * (rng.random(len(start)) < 0.4)
    return kinematics.into_limits(path)


def _clouds(
    judge: Judge, start: FloatArray, margin: float, count: int, rng: np.random.Generator
) -> list[FloatArray | None]:
    """What obstacles are given at each step."""
    given: list[FloatArray | None] = [None] * count
    draw = rng.random()
    if draw < 0.1:
        return given
    if draw < 0.45:  # balls that move
        balls = int(rng.integers(1, 10))
        middle = judge.kinematics.place(start[None]).p[0]
        at = middle[rng.integers(len(middle), size=balls)] + rng.normal(size=(balls, 3)) * 0.4
        speed = rng.normal(size=(balls, 3)) * rng.choice([0.0, 1e-4, 1e-3, 1e-2])
        radii = rng.uniform(0.0, 0.1, (balls, 1))
        return [np.hstack([at + k * speed, radii]) for k in range(count)]
    every = count if rng.random() < 0.4 else int(rng.integers(5, 60))
    for k in range(0, count, every):  # clouds that come and go
        points = round(10 ** rng.uniform(0.0, np.log10(MOST_POINTS - 1)))
        given[k] = draw_cloud(judge, start[None], points, margin, rng)
        if k and rng.random() < 0.2:
            given[k] = NONE
    return given


def _spoil(steps: list[Step], rng: np.random.Generator) -> list[Step]:
    """Some steps are given what makes no sense, now and then until a new cloud comes."""
    spoilt, cloud = [], NONE
    for step in steps:
        given = step
        cloud = step.cloud if step.cloud is not None else cloud
        if rng.random() < 0.03:
            tip = str(rng.choice(list(step.goals)))
            given = replace(
                step, goals={**step.goals, tip: _no_pose(step.goals[tip], rng)}, sound=False
            )
        elif rng.random() < 0.03:
            given = replace(step, cloud=_no_cloud(cloud, rng), sound_cloud=False)
        elif step.cloud is None and rng.random() < 0.2:
            given = replace(step, cloud=cloud)
        spoilt.append(given)
    return spoilt


def _no_pose(T: FloatArray, rng: np.random.Generator) -> FloatArray:
    T = T.copy()
    match rng.integers(4):
        case 0:
            T[rng.integers(3), rng.integers(4)] = rng.choice([np.nan, np.inf, -np.inf])
        case 1:
            T[:3, :3] *= 1.01
        case 2:
            T[:3, 0] *= -1.0
        case 3:
            T[3] = [0.0, 0.0, 0.1, 1.0]
    return T


def _no_cloud(cloud: FloatArray, rng: np.random.Generator) -> FloatArray:
    rows = four_columns(cloud)
    assert rows is not None
    bad = np.concatenate([rows, np.ones((1, 4))])
    match rng.integers(5):
        case 0:
            bad[rng.integers(len(bad)), rng.integers(4)] = rng.choice([np.nan, np.inf])
        case 1:
            bad[rng.integers(len(bad)), 3] = -0.01
        case 2:
            return np.ones((MOST_POINTS + 1, 3))
        case 3:
            return np.ones((3, 5))
        case 4:
            bad[0, 0] = 1e300
    return bad
