"""Drake's InverseKinematics with SNOPT, which knows obstacles as a constraint on distances."""

import importlib
import itertools
from time import perf_counter
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.experiment import Arm
from bench.ik.methods.hulls import Hull, Verdict, hulls_of, radius_of
from bench.ik.methods.problem import Answer, Problem, Terms, with_restarts

# Tried on 25 to 60 problems per arm with nine spheres of 5 cm, 1 to 5 cm from the arm; differences
# are often within noise. Drake's ellipsoids fit the hulls exactly, but their distances to spheres
# are iterative: single solves took seconds.
MAX_SPHERES = 15  # of a hull
EXCESS = 0.008  # how far the spheres that stand for a hull may reach out of it [m]
MARGIN = 1e-4  # least distance that is asked for: SNOPT's constraints hold to a tolerance [m]
INFLUENCE = 0.01  # beyond the margin obstacles do not count: Drake's default [m]
SHARE = 0.9  # of a tolerance that the constraints have
LIMITS = {"Major iterations limit": 100, "Iterations limit": 500}  # of one start


class DrakeSnopt:
    """Pose and distance constraints without a cost, from q0, then from clear random starts.

    Its robot is spheres that cover the hulls, obstacles without a radius are spheres of 1 mm, and
    other pairs are ignored. Making the plant of a scene is not part of any time.

    Raises:
        ImportError: drake is not installed.
        ValueError: A hull is between two links.
    """

    name = "Drake SNOPT"
    language = "C++"

    def __init__(self, arm: Arm, terms: Terms) -> None:
        self._drake: Any = importlib.import_module("pydrake.all")
        self._arm, self._terms = arm, terms
        self._verdict = Verdict(arm, terms)
        self._snopt = self._drake.SnoptSolver()
        self._spheres = [
            (hull.link, hull.center + place * hull.axis, radius)
            for hull in hulls_of(arm.robot)
            for place, radius in covering_spheres(hull)
        ]

    def solve(self, problem: Problem) -> Answer:
        """Solve it. SNOPT does not tell how many iterations and evaluations it took: they are 0."""
        diagram, plant = self._scene(problem.points)
        root = diagram.CreateDefaultContext()
        rng = np.random.default_rng(self._terms.seed)
        began, max_time = perf_counter(), self._terms.max_time
        ik = self._program(problem, plant, plant.GetMyMutableContextFromRoot(root))

        def search(start: FloatArray) -> tuple[FloatArray, int, int]:
            return self._local_solution(ik, start, max_time - (perf_counter() - began)), 0, 1

        solves = self._verdict.of(problem)
        draw = self._verdict.starts(problem, rng)
        return with_restarts(began, max_time, problem.q0, search, solves, draw)

    def _local_solution(self, ik: Any, start: FloatArray, max_time: float) -> FloatArray:
        options = self._drake.SolverOptions()
        for name, value in {**LIMITS, "Time limit": max_time}.items():
            options.SetOption(self._snopt.id(), name, value)
        result = self._snopt.Solve(ik.prog(), start, options)
        robot = self._arm.robot
        return np.clip(result.GetSolution(ik.q()), robot.lower, robot.upper)

    def _program(self, problem: Problem, plant: Any, context: Any) -> Any:
        drake, terms, T = self._drake, self._terms, problem.T_base_tip
        tip, world = plant.GetFrameByName(self._arm.tip_link), plant.world_frame()
        angle = SHARE * terms.rotation_tolerance
        edge = SHARE * terms.position_tolerance / np.sqrt(3)  # half, of a box inside the ball
        ik = drake.InverseKinematics(plant, context)
        ik.AddPositionConstraint(tip, np.zeros(3), world, T[:3, 3] - edge, T[:3, 3] + edge)
        if terms.goal == "pose":
            R = drake.RotationMatrix(T[:3, :3])
            ik.AddOrientationConstraint(tip, drake.RotationMatrix(), world, R, angle)
        else:
            z = np.array([0.0, 0.0, 1.0])
            ik.AddAngleBetweenVectorsConstraint(tip, z, world, T[:3, 2], 0.0, angle)
        if len(problem.points):
            ik.AddMinimumDistanceLowerBoundConstraint(MARGIN, INFLUENCE)
        return ik

    def _scene(self, points: FloatArray) -> tuple[Any, Any]:
        """A diagram with the arm and the obstacles, and its plant."""
        drake, robot = self._drake, self._arm.robot
        builder = drake.DiagramBuilder()
        plant, scene_graph = drake.AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        drake.Parser(plant).AddModels(str(self._arm.urdf))
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(robot.base_link))

        def add(name: str, body: Any, center: FloatArray, radius: float) -> Any:
            friction = drake.CoulombFriction(1.0, 1.0)
            X, shape = drake.RigidTransform(center), drake.Sphere(radius)
            return plant.RegisterCollisionGeometry(body, X, shape, name, friction)

        hulls, obstacles = drake.GeometrySet(), drake.GeometrySet()
        for i, (link, center, radius) in enumerate(self._spheres):
            hulls.Add(add(f"hull{i}", plant.GetBodyByName(link), center, radius))
        for i, point in enumerate(points):
            obstacles.Add(add(f"point{i}", plant.world_body(), point[:3], radius_of(point)))
        plant.Finalize()
        filters = scene_graph.collision_filter_manager()
        declare = drake.CollisionFilterDeclaration
        filters.Apply(declare().ExcludeWithin(hulls).AllowBetween(hulls, obstacles))
        return builder.Build(), plant


def covering_spheres(hull: Hull, excess: float = EXCESS) -> list[tuple[float, float]]:
    """Spheres about points of a hull's axis that cover it: (place from its centre, radius) [m].

    The hull is cut into slices of equal length, as few as reach out of it by at most `excess`.
    """
    for count in range(1, MAX_SPHERES + 1):
        edges = np.linspace(-hull.semi_major, hull.semi_major, count + 1)
        spheres = [_around_slice(hull, low, high) for low, high in itertools.pairwise(edges)]
        if max(radius - _inner_radius(hull, place) for place, radius in spheres) <= excess:
            break
    return spheres


def _around_slice(hull: Hull, low: float, high: float) -> tuple[float, float]:
    """The smallest sphere about a point of the axis that holds the hull between two places."""
    a, b = hull.semi_major, hull.semi_minor
    x = np.linspace(low, high, 101)
    squared_width = b**2 * np.maximum(1 - (x / a) ** 2, 0)
    places = np.linspace(-a, a, 401)  # an end is best held from farther in
    reach = np.sqrt(((x - places[:, None]) ** 2 + squared_width).max(axis=1))
    best = int(np.argmin(reach))
    return float(places[best]), float(reach[best]) * (1 + 1e-4)  # for x is sampled


def _inner_radius(hull: Hull, place: float) -> float:
    """Radius of the largest sphere about a point of the axis inside the hull [m]."""
    x = np.linspace(-hull.semi_major, hull.semi_major, 1001)
    squared_width = hull.semi_minor**2 * np.maximum(1 - (x / hull.semi_major) ** 2, 0)
    return float(np.sqrt(((x - place) ** 2 + squared_width).min()))
