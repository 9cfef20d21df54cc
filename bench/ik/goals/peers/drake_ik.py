"""Drake's InverseKinematics with SNOPT: regions as constraints, contacts as least distances."""

import importlib
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np

from bench.common.arrays import FloatArray
from bench.ik.goals.peers.body import MARGIN, Body
from bench.ik.goals.peers.problems import (
    MAX_TIME,
    Answer,
    Region,
    Search,
    among,
    by_distance,
    from_starts,
    least_of,
)

POINT = 1e-4  # radius that stands for none [m]
BRANCH = 1.0  # a rotation whose axes are square to their targets' is the one near to none [rad]
OPTIONS = {
    "Major feasibility tolerance": 1e-8,
    "Major iterations limit": 200,
    "Time limit": MAX_TIME,
}
X, Y, Z = np.eye(3)


class DrakeIk:
    """Solves a program without a cost from each start; success is what SNOPT reports.

    Places are position constraints, in the region's own frame. Turns are angles between axes, which
    a constraint on the whole angle would leave without a gradient where it is met. Where there are
    contacts, what they allow is looked for from an answer without them.

    Raises:
        ImportError: drake is not installed.
    """

    def __init__(self, body: Body) -> None:
        self._drake: Any = importlib.import_module("pydrake.all")
        self.name = f"Drake {version('drake')}"
        self._body = body
        self._snopt = self._drake.SnoptSolver()
        diagram, self._plant = self._scene()
        self._root = diagram.CreateDefaultContext()
        self._diagram = diagram
        self._at = [self._plant.GetJointByName(name).position_start() for name in body.moving]
        self._options = self._drake.SolverOptions()
        for name, value in OPTIONS.items():
            self._options.SetOption(self._snopt.id(), name, value)

    def solve(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """One program for all."""
        return from_starts(self._search(regions), starts)

    def any_of(self, regions: Sequence[Region], starts: FloatArray) -> Answer:
        """One program for each, nearest first."""
        order = by_distance(regions, self._pose(regions[0].tip, starts[0]))
        answer = among([self._search([regions[k]]) for k in order], starts)
        return replace(answer, index=order[answer.index])

    def nearest(self, T: FloatArray, tip: str, starts: FloatArray) -> Answer:
        """The orientation is a cost."""
        drake = self._drake
        ik = drake.InverseKinematics(self._plant, self._context())
        frame, world = self._frame(tip), self._plant.world_frame()
        R = drake.RotationMatrix(T[:3, :3])
        ik.AddPositionConstraint(frame, np.zeros(3), world, T[:3, 3], T[:3, 3])
        ik.AddOrientationCost(frame, drake.RotationMatrix(), world, R, 1.0)

        def search(start: FloatArray) -> tuple[FloatArray, float]:
            result = self._snopt.Solve(ik.prog(), self._inner(start), self._options)
            cost = result.get_optimal_cost() if result.is_success() else np.inf
            return self._outer(result.GetSolution(ik.q()), start), cost

        return least_of(search, starts)

    def _search(self, regions: Sequence[Region]) -> Search:
        """A search by programs that are made once, when they are needed."""
        programs: list[Any] = []

        def search(start: FloatArray) -> tuple[FloatArray, bool]:
            if not programs:
                programs.extend(self._programs(regions))
            return self._run(programs, start)

        return search

    def _programs(self, regions: Sequence[Region]) -> list[Any]:
        """Without contacts, and with them if there are any."""
        programs = []
        for _ in range(1 + self._body.has_contacts):
            ik = self._drake.InverseKinematics(self._plant, self._context())
            for region in regions:
                if region.look is not None:
                    self._look(ik, region)
                else:
                    self._be_in(ik, region)
            programs.append(ik)
        if self._body.has_contacts:
            programs[1].AddMinimumDistanceLowerBoundConstraint(MARGIN)
        return programs

    def _look(self, ik: Any, region: Region) -> None:
        ahead = np.array([0.0, 0.0, 0.01]), np.array([0.0, 0.0, np.inf])
        ik.AddPositionConstraint(
            self._plant.world_frame(), region.look, self._frame(region.tip), *ahead
        )

    def _be_in(self, ik: Any, region: Region) -> None:
        drake, tip = self._drake, self._frame(region.tip)
        base = self._frame(region.relative_to) if region.relative_to else self._plant.world_frame()
        R, at = drake.RotationMatrix(region.T[:3, :3]), drake.RigidTransform(region.T)
        ends = np.asarray(region.lower), np.asarray(region.upper)
        ik.AddPositionConstraint(tip, np.zeros(3), base, at, *ends)

        def angle(axis: FloatArray, target: FloatArray, least: float, most: float) -> None:
            ik.AddAngleBetweenVectorsConstraint(tip, axis, base, R @ target, least, most)

        right = np.pi / 2
        if region.tilt is not None:
            if region.tilt > 0:
                angle(Z, Z, 0.0, region.tilt)
            else:
                angle(Z, X, right, right)
                angle(Z, Y, right, right)
                angle(Z, Z, 0.0, BRANCH)
            return
        if max(region.turn) > 0:
            most = float(np.linalg.norm(region.turn))
            a, b, c = np.asarray(region.turn) * np.sinc(most / np.pi)
            for one, other, slack in ((X, Y, c), (Y, Z, a), (Z, X, b)):
                angle(one, other, right - slack, right + slack)
                angle(other, one, right - slack, right + slack)
        else:
            most = BRANCH
            for one, other in ((X, Y), (Y, Z), (Z, X)):
                angle(one, other, right, right)
        ik.AddOrientationConstraint(tip, drake.RotationMatrix(), base, R, most)

    def _run(self, programs: Sequence[Any], start: FloatArray) -> tuple[FloatArray, bool]:
        own = self._inner(start)
        for ik in programs:
            result = self._snopt.Solve(ik.prog(), own, self._options)
            own = result.GetSolution(ik.q())
            if not result.is_success():
                break
        return self._outer(own, start), result.is_success()

    def _inner(self, q: FloatArray) -> FloatArray:
        own = np.zeros(self._plant.num_positions())
        own[self._at] = q[self._body.places]
        return own

    def _outer(self, own: FloatArray, start: FloatArray) -> FloatArray:
        q = start.copy()
        q[self._body.places] = own[self._at]
        return q

    def _context(self) -> Any:
        return self._plant.GetMyMutableContextFromRoot(self._root)

    def _frame(self, link: str) -> Any:
        return self._plant.GetFrameByName(self._body.bare_name(link))

    def _pose(self, link: str, q: FloatArray) -> FloatArray:
        context = self._context()
        self._plant.SetPositions(context, self._inner(q))
        pose: FloatArray = self._frame(link).CalcPoseInWorld(context).GetAsMatrix4()
        return pose

    def _scene(self) -> tuple[Any, Any]:
        """A diagram with the body and what it must not touch, and its plant."""
        drake, body = self._drake, self._body
        builder = drake.DiagramBuilder()
        plant, scene_graph = drake.AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        drake.Parser(plant).AddModelsFromString(body.bare, "urdf")
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(body.root))
        friction = drake.CoulombFriction(1.0, 1.0)

        def add(link: Any, X: Any, shape: Any, name: str) -> Any:
            return plant.RegisterCollisionGeometry(link, X, shape, name, friction)

        of_link: dict[str, Any] = {}
        hulls, others = drake.GeometrySet(), drake.GeometrySet()
        for i, (link, a, b, radius) in enumerate(body.capsules if body.has_contacts else ()):
            along = b - a
            length = float(np.linalg.norm(along))
            R = drake.RotationMatrix.MakeFromOneVector(along, 2)
            X, shape = drake.RigidTransform(R, 0.5 * (a + b)), drake.Capsule(radius, length)
            hull = add(plant.GetBodyByName(body.bare_name(link)), X, shape, f"hull{i}")
            of_link.setdefault(link, drake.GeometrySet()).Add(hull)
            hulls.Add(hull)
        for i, point in enumerate(body.points):
            X = drake.RigidTransform(point)
            others.Add(add(plant.world_body(), X, drake.Sphere(POINT), f"point{i}"))
        if body.table is not None:
            X = drake.RigidTransform([0.0, 0.0, body.table - 0.25])
            others.Add(add(plant.world_body(), X, drake.Box(5.0, 5.0, 0.5), "table"))
        plant.Finalize()
        filters = drake.CollisionFilterDeclaration()
        filters.ExcludeWithin(hulls).AllowBetween(hulls, others)
        for one, other in body.apart:
            filters.AllowBetween(of_link[one], of_link[other])
        scene_graph.collision_filter_manager().Apply(filters)
        return builder.Build(), plant
