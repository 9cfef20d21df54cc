"""What is asked: options, goals, clouds, starts. Everything follows from a seed."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import pdoik
from bench.common.arrays import BoolArray, FloatArray
from bench.ik.judges.distances import to_segment
from bench.ik.soak.judge import Goals, Judge, random_configurations
from bench.ik.soak.robots import RobotSpec

# Points of a cloud, answers of a scene with so many, and its share of all scenes.
SIZES = (
    ("none", 0, 0, 1000, 0.36),
    ("1 to 100", 1, 100, 300, 0.32),
    ("100 to 1,000", 100, 1000, 120, 0.22),
    ("1,000 to 10,000", 1_000, 10_000, 25, 0.07),
    ("10,000 to 100,000", 10_000, 100_000, 6, 0.03),
)
SINGLE = 120  # answers of a scene that are asked for one by one, at most
FARTHEST = 1e6  # coordinate that a cloud may have [m]
LONG = 1.0  # a deadline that restarts reach first, so that answers can be had again [s]
TYPES = ("pose", "axis", "position")


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Questions to one robot among one cloud."""

    spec: RobotSpec
    options: dict[str, Any]  # of pdoik.Options, but balance as a dict of its arguments
    goals: list[Goals]  # each of B targets
    size: str  # of the cloud, of SIZES
    cloud: FloatArray | None  # (N, 3) or (N, 4)
    q0: FloatArray | None  # (B, n)
    posture: FloatArray | None  # (n,)
    max_step: FloatArray | None  # (n,)
    single: bool  # asked one by one

    @property
    def count(self) -> int:
        """B."""
        return len(self.goals[0].T)

    @property
    def has_slack(self) -> bool:
        """Whether any goal leaves some room."""
        return any(goal.has_slack for goal in self.goals)


def make_options(values: dict[str, Any]) -> pdoik.Options:
    """The library's options from what a scene holds."""
    changed = {name: value for name, value in values.items() if name != "balance"}
    changed["ignore_obstacles_without_hulls"] = True  # some robots have none
    if values.get("balance") is not None:
        changed["balance"] = pdoik.Balance(**values["balance"])
    return pdoik.Options(**changed)


def make_goal(goal: Goals, T: FloatArray) -> pdoik.Goal:
    """The library's goal of the same kind and slack with the target T, (4, 4)."""
    names = ("type", "axis", "position_slack", "rotation_slack")
    return pdoik.Goal(T, **{name: getattr(goal, name) for name in names})


def four_columns(cloud: FloatArray | None) -> FloatArray | None:
    """Points with a radius each, 0 where none is given."""
    if cloud is None or cloud.shape[-1] == 4:
        return cloud
    return np.concatenate([cloud, np.zeros((*cloud.shape[:-1], 1))], axis=-1)


def draw_scene(judge: Judge, rng: np.random.Generator, at_most: int) -> Scene:
    """A scene for a robot with `at_most` answers."""
    spec, kinematics = judge.kinematics.spec, judge.kinematics
    size, low, high, count, _ = SIZES[rng.choice(len(SIZES), p=[s[-1] for s in SIZES])]
    options = draw_options(judge, rng)
    single = bool(rng.random() < 0.3) or "max_time" in options
    count = max(1, min(count, at_most, SINGLE if single else count))
    reached = random_configurations(kinematics, count, rng)
    plain = "method" not in options and "inner" not in options  # only that knows slack and steps
    goals = draw_goals(judge, reached, options, rng, slack=single and plain)
    cloud = q0 = posture = max_step = None
    if low > 0:
        points = round(10 ** rng.uniform(np.log10(low), np.log10(high)))
        cloud = draw_cloud(judge, reached[:30], points, options["clearance"], rng)
        if points > 1_000:
            options["max_restarts"] = min(options["max_restarts"], 3)
    near = reached + rng.uniform(-0.3, 0.3, reached.shape)
    draw = rng.random()
    if draw < 0.2:
        q0 = near
    elif draw < 0.4:
        q0 = random_configurations(kinematics, count, rng)
    if single and plain:
        if rng.random() < 0.3:
            posture = random_configurations(kinematics, 1, rng)[0]
            options["prefer"] = str(rng.choice(["first", "nearest"]))
        if rng.random() < 0.3:
            q0, max_step = near, rng.uniform(0.0, 1.0) * rng.random(near.shape[1:])
    options.setdefault("max_time", LONG)
    return Scene(
        spec=spec,
        options=options,
        goals=goals,
        size=size,
        cloud=cloud,
        q0=q0,
        posture=posture,
        max_step=max_step,
        single=single,
    )


def draw_options(
    judge: Judge, rng: np.random.Generator, about: FloatArray | None = None
) -> dict[str, Any]:
    """Options of every kind; one in ten has a deadline that strikes.

    If it has to be balanced it is `about` a configuration, (n,), or about any.
    """

    def one_of(values: list[float], p: list[float] | None = None) -> float:
        return float(rng.choice(values, p=p))

    options: dict[str, Any] = {
        "goal": str(rng.choice(TYPES, p=[0.5, 0.25, 0.25])),
        "position_tolerance": one_of([1e-3, 1e-5, 1e-6, 1e-8], [0.2, 0.5, 0.2, 0.1]),
        "rotation_tolerance": one_of([1e-2, 1e-5, 1e-6, 1e-8], [0.2, 0.5, 0.2, 0.1]),
        "clearance": one_of([0.0, 0.005, 0.03]),
        "clearance_tolerance": one_of([1e-6, 1e-4, 0.0], [0.7, 0.2, 0.1]),
        "base_collision": bool(rng.random() < 0.7),
        "self_collision": bool(rng.random() < 0.25),
        "self_clearance": one_of([0.0, 0.01]),
        "max_restarts": int(rng.choice([0, 3, 10])),
        "seed": int(rng.integers(1000)),
    }
    if options["goal"] == "axis" and rng.random() < 0.5:
        axis = rng.normal(size=3)
        options["goal_axis"] = (axis / np.linalg.norm(axis)).tolist()
    draw = rng.random()
    if draw < 0.05:
        options["inner"] = "lbfgs"
    elif draw < 0.08:
        options["method"] = "paper"
    if rng.random() < 0.1:
        options["max_time"] = one_of([1e-4, 1e-3])
    if not judge.kinematics.spec.rows and rng.random() < 0.2:
        q = random_configurations(judge.kinematics, 1, rng)[0] if about is None else about
        options["balance"] = draw_balance(judge, q, rng)
    return options


def draw_balance(judge: Judge, q: FloatArray, rng: np.random.Generator) -> dict[str, Any]:
    """A box, or a polygon of contacts, about where the centre of mass is in a configuration."""
    placed = judge.kinematics.place(q[None], com=True)
    assert placed.com is not None
    com = placed.com[0]
    if rng.random() < 0.5:
        room = rng.uniform(0.02, 0.3, 3)
        return {"com_lower": (com - room).tolist(), "com_upper": (com + room).tolist()}
    link = judge.kinematics.spec.tip_links[0]
    R, p = judge.kinematics.link(placed, link)
    size = rng.uniform(0.05, 0.4)
    corners = com + np.c_[rng.uniform(-size, size, (6, 2)), rng.uniform(-0.02, 0.02, 6)]
    return {
        "contacts": {link: ((corners - p[0]) @ R[0]).tolist()},
        "support_margin": float(rng.choice([0.0, 0.01])),
        "up": [0.0, 0.0, 1.0],
    }


def draw_goals(
    judge: Judge,
    reached: FloatArray,
    options: dict[str, Any],
    rng: np.random.Generator,
    *,
    slack: bool,
    astray: bool = True,
) -> list[Goals]:
    """Where the tips are in some configurations; if `astray`, some moved to where none may be."""
    placed = judge.kinematics.place(reached)
    count = len(reached)
    kinds = rng.random(count) * (1.0 if astray else 0.0)
    goals: list[Goals] = []
    for tip in judge.kinematics.spec.tip_links:
        if goals and rng.random() < 0.3:
            continue  # a tip without a goal is free
        T = np.tile(np.eye(4), (count, 1, 1))
        T[:, :3, :3], T[:, :3, 3] = judge.kinematics.link(placed, tip)
        off = (kinds > 0.85) & (kinds < 0.97)
        T[off, :3, 3] += rng.uniform(-0.3, 0.3, (int(off.sum()), 3))
        if off.any():
            turns = Rotation.from_rotvec(rng.normal(size=(int(off.sum()), 3)) * 0.5)
            T[off, :3, :3] = turns.as_matrix() @ T[off, :3, :3]
        T[kinds >= 0.97, :3, 3] += rng.uniform(-10.0, 10.0, 3)
        own: dict[str, Any] = {"type": options["goal"]}
        own["axis"] = tuple(options.get("goal_axis", (0.0, 0.0, 1.0)))
        if slack and rng.random() < 0.6:
            own["type"] = str(rng.choice(TYPES))
            for name, most in (("position_slack", 0.1), ("rotation_slack", np.pi)):
                room = rng.choice([0.0, 0.0, 1.0], 3) * rng.uniform(0.0, most, 3)
                own[name] = tuple(room.tolist())
        goals.append(Goals(tip=tip, T=T, **own))
    return goals


def draw_cloud(
    judge: Judge, kept: FloatArray, count: int, margin: float, rng: np.random.Generator
) -> FloatArray:
    """Points about the robot, on walls or anywhere; mostly some configurations are kept free."""
    at = judge.kinematics.place(kept).p.reshape(-1, 3)
    middle, spread = at.mean(axis=0), at.std(axis=0) + 0.3
    cloud = middle + rng.uniform(-2.0, 2.0, (count, 3)) * spread
    if rng.random() < 0.4:  # walls
        axis = int(rng.integers(3))
        cloud[:, axis] = middle[axis] + rng.choice([-1.0, 0.6, 1.2]) * spread[axis]
    if rng.random() < 0.5:
        cloud = np.c_[cloud, rng.choice([0.0, 1.0], count) * rng.uniform(0.0, 0.06, count)]
    if rng.random() < 0.03:  # far away as well
        far = rng.random(count) < 0.2
        cloud[far, :3] = (cloud[far, :3] * 10 ** rng.uniform(1, 6)).clip(-FARTHEST, FARTHEST)
    if rng.random() < 0.03:
        cloud[: count // 2] = cloud[0]
    if len(judge.A) and rng.random() < 0.75:
        kept = kept[: max(1, 200_000 // (count * len(judge.A)))]
        free = rng.integers(1, len(kept) + 1)
        cloud = cloud[_clear_of(judge, kept[:free], cloud, margin + 0.002)]
    return np.ascontiguousarray(cloud)


def _clear_of(judge: Judge, kept: FloatArray, cloud: FloatArray, margin: float) -> BoolArray:
    """Points that are clear of every hull by a bound of their distance, (N,)."""
    points = four_columns(cloud)
    assert points is not None
    clear = np.ones(len(cloud), dtype=bool)
    for ends in zip(*judge.hulls(judge.kinematics.place(kept)), strict=True):
        for p, q, A, is_capsule in zip(*ends, judge.A, judge.swept, strict=True):
            if is_capsule:
                s = to_segment(points[:, :3], p, q)
            else:
                s = sum(np.linalg.norm(points[:, :3] - end, axis=1) for end in (p, q)) / 2
            clear &= s - points[:, 3] >= A + margin
    return clear
