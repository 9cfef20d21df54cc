"""How the obstacles are given to the solver: as a cloud of their surfaces, or as shapes."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import pdoik
from bench.common.arrays import FloatArray
from bench.ik.problems.problem import Problem
from bench.ik.problems.solids import Solid
from pdoik.scenes import Piece, Thing, mesh, shapes_of

LEAF = 0.01  # of the cloud [m]
SPACING = LEAF / 3  # of the points of a surface [m]
TOUCH = 0.08  # how far from its target a tool may touch where it has to: as wide as a flange [m]


class MethodError(RuntimeError):
    """A method that is not there, or cannot run here."""


class Method:
    """pdoik's default method with obstacles given in one of the ways of WAYS.

    Args:
        way: How the solids are given.
        robot: With its hulls.
        budgets: max_time of each solve of a problem [s].
        like: A problem of the set: by which links its robots stand, whether the base may touch, and
            whether the tool has to. Of shapes it is said which the tool may touch; a cloud has no
            names, so what is near the target may be touched there.
        spacing: Of the points of a surface that clouds are made of [m].
        leaf: Of the grid that thins them [m].

    Raises:
        MethodError: The way is unknown.
    """

    def __init__(
        self,
        way: str,
        robot: pdoik.Robot,
        budgets: Sequence[float],
        like: Problem | None = None,
        spacing: float = SPACING,
        leaf: float = LEAF,
    ) -> None:
        if way not in WAYS:
            raise MethodError(f"method {way!r} is not one of {sorted(WAYS)}")
        self.name, self.budgets = way, tuple(budgets)
        self._prepare = WAYS[way](robot, spacing, leaf)
        contacts = like.contacts if like else {}
        may_touch = {link for link, _ in like.allowed} if like else set()
        tool_touches = bool((may_touch & set(robot.link_names)) - {robot.base_link, *contacts})
        options = {
            "max_restarts": 1_000_000,
            "self_collision": True,
            "balance": pdoik.Balance(contacts=contacts) if contacts else pdoik.Balance(),
            "touch": pdoik.Touch(radius=TOUCH if tool_touches and way != "shapes" else 0.0),
            "base_collision": robot.base_link not in may_touch,
        }
        self._solvers = {
            budget: pdoik.Solver(robot, pdoik.Options(max_time=budget, **options))
            for budget in self.budgets
        }

    def take_in(self, problem: Problem) -> tuple[Any, float]:
        """A problem's obstacles as the solver has them, for any number of solves; the time [s]."""
        begun = time.perf_counter()
        return self._prepare(problem), time.perf_counter() - begun

    def answer(
        self, problem: Problem, obstacles: Any, budget: float, start: int = 0
    ) -> pdoik.Result:
        """Within one of the budgets.

        Args:
            problem: Any of the set.
            obstacles: Its, as they were taken in.
            budget: [s].
            start: 0 for none, else which one at random.
        """
        solver = self._solvers[budget]
        robot, q0 = solver.robot, None
        if start > 0:
            turns = np.isinf(robot.upper - robot.lower)
            low, high = np.where(turns, -np.pi, robot.lower), np.where(turns, np.pi, robot.upper)
            q0 = np.random.default_rng(start).uniform(low, high)
        return solver.solve(_goals(problem), q0=q0, obstacles=obstacles)

    def touches(self, problem: Problem, obstacles: Any) -> bool:
        """Whether the defining configuration touches, by the hulls' own account."""
        solver = self._solvers[self.budgets[0]]
        return not solver.judge(_goals(problem), problem.goal_q, obstacles=obstacles).success


def _goals(problem: Problem) -> Any:
    one, *others = problem.targets.values()
    return dict(problem.targets) if others else one


def surface_cloud(
    solids: Sequence[Solid], sink: bool = False, spacing: float = SPACING, leaf: float = LEAF
) -> FloatArray:
    """Balls that hold the solids' surfaces, (N, 4): one for each cell of a grid [m].

    Sunk into the solids they stand out less.
    """
    points = np.concatenate([solid.sample(spacing) for solid in solids])
    balls = pdoik.voxel_downsample(points, leaf, radii=True, solid=sink)
    balls[:, 3] += spacing / np.sqrt(2)  # as far as the surface may be from a point of the grid
    return balls


def _cloud(
    _: pdoik.Robot, spacing: float, leaf: float, sink: bool = False
) -> Callable[[Problem], Any]:
    def scene(problem: Problem) -> pdoik.Cloud | None:
        solids = problem.solids
        return pdoik.Cloud(surface_cloud(solids, sink, spacing, leaf)) if solids else None

    return scene


def _shapes(robot: pdoik.Robot, *_: float) -> Callable[[Problem], Any]:
    def scene(problem: Problem) -> pdoik.Scene:
        allowed = [pair for pair in problem.allowed if pair[0] in robot.link_names]
        for solid in problem.solids:
            if not _is_convex(solid):
                raise MethodError(f"{solid.name} is not convex: give it as a cloud")
        things = [Thing(name=solid.name, pieces=(_piece(solid),)) for solid in problem.solids]
        return pdoik.Scene(shapes_of(things, Path(problem.name)), allowed=allowed)

    return scene


def _piece(solid: Solid) -> Piece:
    if solid.kind == "mesh":
        return mesh(solid.vertices, solid.faces, solid.T, solid.name)
    return Piece(entry=solid.name, kind=solid.kind, size=solid.size, T=solid.T)


def _is_convex(solid: Solid) -> bool:
    return solid.kind != "mesh" or bool(solid.surface().is_convex)


def usual_way(problems: Sequence[Problem]) -> str:
    """Shapes; sunk clouds where something is a mesh that is not convex."""
    convex = all(_is_convex(solid) for problem in problems for solid in problem.solids)
    return "shapes" if convex else "solid_cloud"


WAYS = {"cloud": _cloud, "solid_cloud": partial(_cloud, sink=True), "shapes": _shapes}
