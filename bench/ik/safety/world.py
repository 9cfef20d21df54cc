"""Robots as they come, obstacles, and how far they are apart by Pinocchio, NumPy and coal."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Any

import coal
import numpy as np

import pdoik
from bench.common.arrays import FloatArray, z_along
from bench.ik.judges.distances import to_segment
from bench.ik.soak.hulls import capsules
from bench.ik.soak.judge import Asked, Judge
from bench.ik.soak.robots import RobotSpec, builtin_spec

ARMS = ("panda", "ur10", "iiwa14")
PERIOD = 0.001  # of a control loop [s]
UNHURRIED = 0.2  # a budget that does not strike [s]
FAR = 0.01  # from a box: no figure is needed beyond [m]
ROUNDING = 1e-9  # what two ways to compute one figure may differ by [m]
KEPT = Asked(self_collision=True)
NO_BALLS = np.zeros((0, 4))
SOLE = [(x, y, -0.07) for x in (-0.046, 0.17) for y in (-0.04, 0.04)]  # of an H1's foot [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A solid of a size [m] somewhere."""

    size: FloatArray  # (3,)
    T: FloatArray  # (4, 4)

    def shape(self, name: str) -> pdoik.Shape:
        """The library's."""
        return pdoik.Shape.box(name, self.size, self.T)


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """What is around a robot."""

    balls: FloatArray  # centres and radii, (N, 4) [m]
    boxes: Sequence[Box] = ()

    def given(self) -> FloatArray | list[pdoik.Shape] | None:
        """As a Tracker takes it: either kind."""
        assert not (len(self.balls) and self.boxes)
        if self.boxes:
            return [box.shape(f"box{k}") for k, box in enumerate(self.boxes)]
        return self.balls if len(self.balls) else None


@cache
def judge_of(name: str) -> Judge:
    """Judge of a built-in robot with its hulls."""
    return Judge(builtin_spec(name), robot_of(name).joint_names)


@cache
def robot_of(name: str) -> pdoik.Robot:
    """A built-in robot, made of the same description."""
    return builtin_spec(name).make()


def without_hulls(spec: RobotSpec) -> RobotSpec:
    """A robot that only its joints hold back."""
    return replace(spec, spheres=[], spheroids=[], capsules=[], ignored_pairs=[])


def pose_of(judge: Judge, q: FloatArray, link: str = "") -> FloatArray:
    """Pose of a link, the first tip by default, (4, 4)."""
    link = link or judge.kinematics.spec.tip_links[0]
    T = np.eye(4)
    R, p = judge.kinematics.link(judge.kinematics.place(q[None]), link)
    T[:3, :3], T[:3, 3] = R[0], p[0]
    return T


def distances(judge: Judge, Q: FloatArray, world: World) -> tuple[FloatArray, FloatArray]:
    """Distances of the robot to the world and to itself in configurations (B, n), (B,) each [m]."""
    a, b = judge.hulls(judge.kinematics.place(Q))
    clear = judge.clearance(a, b, world.balls, KEPT)
    if world.boxes:
        p, q, radii = capsules(a, b, judge.A, judge.swept)
        for k, box in product(range(len(Q)), world.boxes):
            clear[k] = min(clear[k], box_gap(p[k], q[k], radii[k], box))
    return clear, judge.self_distance(a, b)


def box_gap(p: FloatArray, q: FloatArray, radii: FloatArray, box: Box) -> float:
    """Distance of the nearest capsule, (H, 3) and (H,), to a box; far away a lower bound [m]."""
    bounds = to_segment(box.T[:3, 3], p, q) - radii - 0.5 * np.linalg.norm(box.size)
    near = bounds < FAR
    exact = to_box(p[near], q[near], radii[near], box)[0]
    return float(min(exact.min(initial=np.inf), bounds[~near].min(initial=np.inf)))


def to_box(
    p: FloatArray, q: FloatArray, radii: FloatArray, box: Box
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Distances of capsules to a box: as `to_solid`."""
    return to_solid(p, q, radii, coal.Box(*box.size), box.T)


def to_solid(
    p: FloatArray, q: FloatArray, radii: FloatArray, solid: Any, T_base_solid: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Distances (H,) of capsules to a coal shape, nearest points of their cores and normals."""
    place = coal.Transform3s(T_base_solid[:3, :3], T_base_solid[:3, 3])
    request, gaps = coal.DistanceRequest(True), np.empty(len(p))
    points, normals = np.empty((2, len(p), 3))
    for k, (one, other, radius) in enumerate(zip(p, q, radii, strict=True)):
        axis = other - one
        length = float(np.linalg.norm(axis))
        core = coal.Capsule(float(radius), length)
        T = coal.Transform3s(z_along(axis / length) if length > 0 else np.eye(3), (one + other) / 2)
        found = coal.DistanceResult()
        gaps[k] = coal.distance(core, T, solid, place, request, found)
        normals[k] = found.normal  # from the capsule to the solid
        points[k] = found.getNearestPoint1() - radius * found.normal
    return gaps, points, normals


def h1_stance() -> tuple[RobotSpec, dict[str, Any], FloatArray]:
    """An H1 on both feet whose base is the left one, its options, and a posture to start from."""
    spec = replace(
        builtin_spec("h1"),
        base_link="left_ankle_link",
        tip_links=["right_ankle_link", "left_elbow_link"],
    )
    options: dict[str, Any] = {
        "balance": {
            "contacts": {"left_ankle_link": SOLE, "right_ankle_link": SOLE},
            "support_margin": 0.02,
        },
        "self_collision": True,
        "rotation_weight": 0.3,
    }
    bend = {"knee": 0.6, "hip_pitch": -0.3, "ankle": -0.3}
    bend |= {"left_shoulder_roll": 0.5, "right_shoulder_roll": -0.5, "left_shoulder_pitch": -0.6}
    names = spec.make().joint_names
    bent = [next((a for part, a in bend.items() if part in name), 0.0) for name in names]
    return spec, options, np.array(bent)
