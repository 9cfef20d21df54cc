"""How the obstacles are given to the solver: as a cloud of their surfaces, or as shapes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from bench.problems.problem import Problem
from bench.problems.solids import Solid

import pdoik

FloatArray = npt.NDArray[np.float64]
LEAF = 0.01  # of the cloud [m]
FINER = 3  # points of a surface per leaf, in each direction
MILLIMETRE, MILLIRADIAN = 1e-3, 1e-3


class MethodError(RuntimeError):
    """A method that is not there, or cannot run here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a method said of one problem."""

    claimed: bool
    q: FloatArray  # (n,) [rad] or [m]
    time: float  # of the solve alone [s]
    intake: float  # of taking in the scene before it [s]
    reason: str  # its status and worst constraint


class Method(Protocol):
    """Answers problems of one robot."""

    def answer(self, problem: Problem) -> Answer:
        """Within the budget that the method was made with."""

    def touches(self, problem: Problem) -> bool | None:
        """Whether the defining configuration touches by the method's own account."""


def make_method(name: str, robot: pdoik.Robot, budget: float) -> Method:
    """A method for a robot with hulls.

    Args:
        name: One of METHODS.
        robot: With its hulls.
        budget: max_time [s].

    Raises:
        MethodError: It is unknown, or needs what this pdoik does not have.
    """
    if name not in METHODS:
        raise MethodError(f"method {name!r} is not one of {sorted(METHODS)}")
    return _Solving(robot, budget, METHODS[name]())


class _Solving:
    """pdoik's default method; `prepare` turns solids into what `solve` takes."""

    def __init__(
        self, robot: pdoik.Robot, budget: float, prepare: Callable[[Problem], Any]
    ) -> None:
        options = pdoik.Options(
            max_time=budget,
            max_restarts=1_000_000,
            position_tolerance=MILLIMETRE,
            rotation_tolerance=MILLIRADIAN,
            self_collision=True,
        )
        self._solver, self._prepare = pdoik.Solver(robot, options), prepare
        self._last: tuple[Problem, Any] | None = None

    def answer(self, problem: Problem) -> Answer:
        begun = time.perf_counter()
        obstacles = self._obstacles(problem)
        intake = time.perf_counter() - begun
        result = self._solver.solve(_goals(problem), obstacles=obstacles)
        return Answer(
            claimed=result.success,
            q=np.asarray(result.q),
            time=result.time,
            intake=intake + result.intake,
            reason=f"{result.status}: {result.worst_constraint}",
        )

    def touches(self, problem: Problem) -> bool | None:
        if problem.goal_q is None:
            return None
        verdict = self._solver.judge(
            _goals(problem), problem.goal_q, obstacles=self._obstacles(problem)
        )
        return not verdict.success

    def _obstacles(self, problem: Problem) -> Any:
        """Kept between the solves of one problem."""
        if self._last is None or self._last[0] is not problem:
            self._last = (problem, self._prepare(problem))
        return self._last[1]


def _goals(problem: Problem) -> Any:
    if len(problem.targets) == 1:
        return next(iter(problem.targets.values()))
    return dict(problem.targets)


def surface_cloud(solids: Sequence[Solid], leaf: float = LEAF) -> FloatArray:
    """Balls that hold the solids' surfaces, (N, 4): one for each cell of a grid [m]."""
    spacing = leaf / FINER
    points = np.concatenate([solid.sample(spacing) for solid in solids])
    balls = pdoik.voxel_downsample(points, leaf, radii=True)
    balls[:, 3] += spacing / np.sqrt(2)  # as far as the surface may be from a point of the grid
    return balls


def _cloud() -> Callable[[Problem], Any]:
    return lambda problem: pdoik.Cloud(surface_cloud(problem.solids)) if problem.solids else None


def _shapes() -> Callable[[Problem], Any]:
    if not hasattr(pdoik, "Shape"):
        raise MethodError("method 'shapes' needs pdoik.Shape, which this pdoik does not have yet")
    return lambda problem: [_shape(solid) for solid in problem.solids]


def _shape(solid: Solid) -> Any:
    shape = pdoik.Shape  # type: ignore[attr-defined]
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
        case "mesh":
            return shape.convex_mesh(solid.name, solid.vertices, solid.T)
    raise MethodError(f"{solid.name}: no shape for a {solid.kind}")


METHODS = {"cloud": _cloud, "shapes": _shapes}
