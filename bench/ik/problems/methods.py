"""How the obstacles are given to the solver: as a cloud of their surfaces, or as shapes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from bench.ik.problems.problem import Problem
from bench.ik.problems.solids import Solid

FloatArray = npt.NDArray[np.float64]
LEAF = 0.01  # of the cloud [m]
SPACING = LEAF / 3  # of the points of a surface [m]
TOUCH = 0.08  # how far from its target a tool may touch where it has to: as wide as a flange [m]


class MethodError(RuntimeError):
    """A method that is not there, or cannot run here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a method said of one problem."""

    claimed: bool
    q: FloatArray  # (n,) [rad] or [m]
    time: float  # of the solve alone [s]
    reason: str  # its status and worst constraint


@dataclass(frozen=True, slots=True, kw_only=True)
class TakenIn:
    """A problem's obstacles as the solver has them; they serve any number of solves."""

    obstacles: Any
    time: float  # that it took [s]


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
    ) -> None:
        if way not in WAYS:
            raise MethodError(f"method {way!r} is not one of {sorted(WAYS)}")
        self.name, self.budgets = way, tuple(budgets)
        self._prepare = WAYS[way](robot, spacing)
        contacts = like.contacts if like else {}
        balance = pdoik.Balance(contacts=contacts) if contacts else pdoik.Balance()
        may_touch = {link for link, _ in like.allowed} if like else set()
        tool_touches = bool((may_touch & set(robot.link_names)) - {robot.base_link, *contacts})
        self._solvers = {
            budget: pdoik.Solver(
                robot,
                pdoik.Options(
                    max_time=budget,
                    max_restarts=1_000_000,
                    self_collision=True,
                    balance=balance,
                    touch=pdoik.Touch(radius=TOUCH if tool_touches and way != "shapes" else 0.0),
                    base_collision=robot.base_link not in may_touch,
                ),
            )
            for budget in self.budgets
        }

    def take_in(self, problem: Problem) -> TakenIn:
        """What the solver needs of the scene, made before the clock runs."""
        begun = time.perf_counter()
        obstacles = self._prepare(problem)
        return TakenIn(obstacles=obstacles, time=time.perf_counter() - begun)

    def answer(self, problem: Problem, scene: TakenIn, budget: float) -> Answer:
        """Within one of the budgets."""
        result = self._solvers[budget].solve(_goals(problem), obstacles=scene.obstacles)
        return Answer(
            claimed=result.success,
            q=np.asarray(result.q),
            time=result.time,
            reason=f"{result.status}: {result.worst_constraint}",
        )

    def touches(self, problem: Problem, scene: TakenIn) -> bool:
        """Whether the defining configuration touches, by the hulls' own account."""
        solver = self._solvers[self.budgets[0]]
        verdict = solver.judge(_goals(problem), problem.goal_q, obstacles=scene.obstacles)
        return not verdict.success


def _goals(problem: Problem) -> Any:
    if len(problem.targets) == 1:
        return next(iter(problem.targets.values()))
    return dict(problem.targets)


def surface_cloud(
    solids: Sequence[Solid], leaf: float = LEAF, sink: bool = False, spacing: float = SPACING
) -> FloatArray:
    """Balls that hold the solids' surfaces, (N, 4): one for each cell of a grid [m].

    Args:
        solids: What is there.
        leaf: Edge of the cells [m].
        sink: Sink the balls into the solids, so that they stand out less.
        spacing: Of the points that are sampled of the surface [m].
    """
    points = np.concatenate([solid.sample(spacing) for solid in solids])
    balls = pdoik.voxel_downsample(points, leaf, radii=True, solid=sink)
    balls[:, 3] += spacing / np.sqrt(2)  # as far as the surface may be from a point of the grid
    return balls


def _cloud(robot: pdoik.Robot, spacing: float, sink: bool = False) -> Callable[[Problem], Any]:
    del robot  # which a cloud knows nothing of

    def scene(problem: Problem) -> pdoik.Cloud | None:
        if not problem.solids:
            return None
        return pdoik.Cloud(surface_cloud(problem.solids, sink=sink, spacing=spacing))

    return scene


def _shapes(robot: pdoik.Robot, spacing: float) -> Callable[[Problem], Any]:
    del spacing  # shapes are exact

    def scene(problem: Problem) -> pdoik.Scene:
        allowed = [pair for pair in problem.allowed if pair[0] in robot.link_names]
        return pdoik.Scene([_shape(solid) for solid in problem.solids], allowed=allowed)

    return scene


def _shape(solid: Solid) -> pdoik.Shape:
    shape = pdoik.Shape
    match solid.kind:
        case "box":
            return shape.box(solid.name, solid.size, solid.T)
        case "sphere":
            return shape.sphere(solid.name, solid.T[:3, 3], *solid.size)
        case "cylinder":
            return shape.cylinder(solid.name, *solid.size, solid.T)
        case "capsule":
            return shape.capsule(solid.name, *solid.size, solid.T)
        case "half_space":
            return shape.half_space(solid.name, solid.T[:3, 2], solid.T[:3, 3])
        case "mesh" if not _is_convex(solid):
            raise MethodError(f"{solid.name} is not convex: give it as a cloud")
        case "mesh":
            return shape.convex_mesh(solid.name, solid.vertices, solid.T)
    raise MethodError(f"{solid.name}: no shape for a {solid.kind}")


def _is_convex(solid: Solid) -> bool:
    return solid.kind != "mesh" or bool(solid.surface().is_convex)


def usual_way(problems: Sequence[Problem]) -> str:
    """Shapes; sunk clouds where something is a mesh that is not convex."""
    convex = all(_is_convex(solid) for problem in problems for solid in problem.solids)
    return "shapes" if convex else "solid_cloud"


WAYS = {"cloud": _cloud, "solid_cloud": partial(_cloud, sink=True), "shapes": _shapes}
