"""Scenes that are hard: crowded, reached into, half seen, at limits and near singularities.

Each is made around a random configuration that solves it: the configuration defines the target and
is clear of every point by the built-in hulls, which all methods share.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.optimize import minimize

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.judges.meshes import Body, MeshJudge
from bench.ik.scenes.around import random_scene_around
from bench.ik.scenes.camera import depth_view
from bench.ik.scenes.objects import ObjectModel, SceneError

SPHERES = 9
GAPS = (0.01, 0.05)  # from the arm's hulls to a sphere's surface [m]
RADII = (0.03, 0.08)  # of the spheres [m]
OBJECTS = 9  # of a camera's scene
SURFACE_STEP = 0.01  # between the points that walls and bars are sampled at [m]
LEAF = 0.04  # of the voxel grid over them [m]
CAMERA_LEAF = 0.03  # of that over a camera's cloud [m]
CAMERA_GROWTH = 0.005  # by which its radii are enlarged, for what noise and gaps hide [m]
DRAWS = 3000  # configurations tried for one scene
NOTHING = np.empty((0, 4))


@dataclass(frozen=True, slots=True)
class HardProblem:
    """A target among obstacle points, both of which a known configuration satisfies."""

    q: FloatArray  # that configuration, (n,) [rad]
    T_base_tip: FloatArray  # (4, 4)
    points: FloatArray  # (K, 4), with a radius each [m]
    bodies: tuple[Body, ...] = ()  # what the points were seen of, where it is meshes


class Maker:
    """Makes problems for one arm; `models` are what a camera sees."""

    def __init__(self, arm: Arm, judge: MeshJudge, models: Sequence[ObjectModel]) -> None:
        self.arm, self.judge, self.models = arm, judge, models
        self._solver = pdoik.Solver(arm.robot)

    def clearance(self, q: FloatArray, points: FloatArray) -> float:
        """Clearance of the hulls at q from points with radii [m]."""
        return float(self._solver.judge(self.arm.robot.fk(q), q, obstacles=points).clearance)

    def problem(
        self, q: FloatArray, points: FloatArray = NOTHING, bodies: tuple[Body, ...] = ()
    ) -> HardProblem:
        """The problem that q solves."""
        return HardProblem(q, self.arm.robot.fk(q), points, bodies)


def crowded(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """Nine spheres of 3 to 8 cm, 1 to 5 cm away from a point of the arm each."""
    robot = maker.arm.robot
    q = maker.arm.random_configuration(rng)
    on_arm = [
        robot.fk(q, link) @ [*(np.add(a, t * np.subtract(b, a))), 1.0]
        for link, a, _, b, _ in robot.occupancy.spheroids
        for t in (0.0, 0.5, 1.0)
    ]
    spheres: list[FloatArray] = []
    while len(spheres) < SPHERES:
        centre = on_arm[rng.integers(len(on_arm))][:3]
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        radius, gap = rng.uniform(*RADII), rng.uniform(*GAPS)
        # Away from the arm until the gap is as drawn: clearance grows about as the distance does.
        distance = radius
        for _ in range(61):
            sphere = np.array([*(centre + distance * direction), radius])
            error = gap - maker.clearance(q, sphere[None])
            if abs(error) < 1e-4:
                break
            distance += error
        if abs(error) < 1e-3:
            spheres.append(sphere)
    return maker.problem(q, np.array(spheres))


def shelf(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """The tip 5 to 15 cm deep in the middle one of three compartments, one above the other."""

    def at(T: FloatArray) -> list[trimesh.Trimesh]:
        width, height, depth = rng.uniform([0.34, 0.28, 0.25], [0.5, 0.42, 0.35])
        reach = rng.uniform(0.05, 0.15)
        z = depth / 2 - reach
        boards = (-1.5 * height, -height / 2, height / 2, 1.5 * height)
        return [
            *(_box((0.02, 3 * height, depth), [x, 0, z], T) for x in (-width / 2, width / 2)),
            *(_box((width, 0.02, depth), [0, y, z], T) for y in boards),
            _box((width, 3 * height, 0.02), [0, 0, depth - reach + 0.01], T),
        ]

    return _reach_in(maker, rng, at)


def box_bin(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """The tip in a bin that is open towards where the arm comes from."""

    def at(T: FloatArray) -> list[trimesh.Trimesh]:
        a, b, depth = rng.uniform([0.3, 0.3, 0.2], [0.5, 0.5, 0.35])
        reach = rng.uniform(0.05, 0.6 * depth)
        z = depth / 2 - reach
        return [
            *(_box((0.015, b, depth), [s * a / 2, 0, z], T) for s in (-1, 1)),
            *(_box((a, 0.015, depth), [0, s * b / 2, z], T) for s in (-1, 1)),
            _box((a, b, 0.015), [0, 0, depth - reach], T),
        ]

    return _reach_in(maker, rng, at)


def bars(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """The tip behind a grating of parallel bars, reached between two of them."""
    transforms = trimesh.transformations

    def at(T: FloatArray) -> list[trimesh.Trimesh]:
        spacing, radius = rng.uniform(0.24, 0.34), rng.uniform(0.01, 0.02)
        behind = rng.uniform(0.05, 0.15)
        turn = transforms.rotation_matrix(rng.uniform(0, np.pi), [0, 0, 1])
        upright = transforms.rotation_matrix(np.pi / 2, [1, 0, 0])
        offset = rng.uniform(-0.03, 0.03)
        cylinders = []
        for k in (-2.5, -1.5, -0.5, 0.5, 1.5, 2.5):
            bar = trimesh.creation.cylinder(radius=radius, height=1.2, sections=16)
            shift = transforms.translation_matrix([k * spacing + offset, 0, -behind])
            cylinders.append(bar.apply_transform(T @ turn @ shift @ upright))
        return cylinders

    return _reach_in(maker, rng, at)


def camera(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """Nine objects as one depth camera sees them: noise, dropouts, no backs, nothing hidden."""
    for _ in range(DRAWS):
        q, _, bodies = random_scene_around(maker.arm, maker.judge, maker.models, OBJECTS, rng)
        seen = depth_view([body.triangles for body in bodies], rng)
        points = pdoik.voxel_downsample(seen, CAMERA_LEAF, radii=True)
        points[:, 3] += CAMERA_GROWTH
        if maker.clearance(q, points) > 0.0:
            return maker.problem(q, points, bodies)
    raise SceneError(f"camera: {DRAWS} scenes, none of them clear")


def at_limits(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """Two to four joints exactly at a limit; no obstacles."""
    robot = maker.arm.robot
    q = maker.arm.random_configuration(rng)
    for i in rng.choice(robot.dof, rng.integers(2, 5), replace=False):
        q[i] = robot.lower[i] if rng.uniform() < 0.5 else robot.upper[i]
    return maker.problem(q)


def near_singular(maker: Maker, rng: np.random.Generator) -> HardProblem:
    """The Jacobian's least singular value brought below 1e-4 of the largest; no obstacles."""
    robot = maker.arm.robot
    lower, upper = robot.lower, robot.upper

    def condition(q: FloatArray) -> float:
        values = np.linalg.svd(robot.jacobian(np.clip(q, lower, upper)), compute_uv=False)
        return float(np.log(values[-1] / values[0] + 1e-12))

    for _ in range(DRAWS):
        found = minimize(condition, maker.arm.random_configuration(rng), method="Powell", tol=1e-3)
        if found.fun < np.log(1e-4):
            return maker.problem(np.clip(found.x, lower, upper))
    raise SceneError(f"near_singular: {DRAWS} starts, none of them led to a singularity")


FAMILIES: Mapping[str, Callable[[Maker, np.random.Generator], HardProblem]] = {
    "crowded": crowded,
    "shelf": shelf,
    "bin": box_bin,
    "bars": bars,
    "camera": camera,
    "at limits": at_limits,
    "near singular": near_singular,
}


def _reach_in(
    maker: Maker,
    rng: np.random.Generator,
    structure_at: Callable[[FloatArray], list[trimesh.Trimesh]],
) -> HardProblem:
    """A structure built about the tip, whose z points in, that the arm's hulls are clear of."""
    for _ in range(DRAWS):
        q = maker.arm.random_configuration(rng)
        T = maker.arm.robot.fk(q)
        if T[2, 3] < 0.1 or np.linalg.norm(T[:2, 3]) < 0.3:
            continue  # under the table, or about the arm's own foot
        walls = [np.asarray(wall.triangles) for wall in structure_at(T)]
        bodies = tuple(Body.of(f"wall {k}", wall) for k, wall in enumerate(walls))
        if maker.judge.collision(q, bodies) is not None:
            continue
        points = np.concatenate([_sampled(triangle) for wall in walls for triangle in wall])
        cloud = pdoik.voxel_downsample(points, LEAF, radii=True)
        if maker.clearance(q, cloud) > 0.0:
            return maker.problem(q, cloud, bodies)
    raise SceneError(f"{DRAWS} configurations, none of them clear of what was built about its tip")


def _box(extents: Sequence[float], center: Sequence[float], T: FloatArray) -> trimesh.Trimesh:
    return trimesh.creation.box(extents=extents).apply_translation(center).apply_transform(T)


def _sampled(triangle: FloatArray) -> FloatArray:
    """Points on a triangle, none of it farther than the step from one of them."""
    a, b, c = triangle
    longest = max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b))
    n = int(np.ceil(longest / SURFACE_STEP))
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    i, j = i[i + j <= n, None] / n, j[i + j <= n, None] / n
    return a + i * (b - a) + j * (c - a)
