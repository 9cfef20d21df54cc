"""How well paths can be followed from one place: the question, and the answer's figures."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik.base_paths import moved_path, moved_points, moved_shapes, way_of
from pdoik.base_places import STATUSES, Moves, transform_of
from pdoik.options import Options
from pdoik.solver import Solver

FloatArray = npt.NDArray[np.float64]

_LOOK_TIME, _LOOK_RESTARTS = 1.0, 16  # of a station that is looked at before the path [s]
_SOON = {"max_time": 1e-3}  # of a question that is only tried out
_ROWS = 200  # that a singularity is looked for at


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """All but the places, as other processes can have it."""

    robot: _core.Robot
    options: Options
    paths: tuple[Any, ...]  # poses (N, 4, 4), or goals as _given_goals gives them
    obstacles: tuple[Any, ...]  # shapes, points or None, contacts
    part: tuple[_core.Shape, ...]
    move: Moves
    asked: dict[str, Any]  # of Solver.solve_path
    every: int

    def digest(self, places: FloatArray) -> str:
        """The same for the same question."""
        content = [
            *(self.robot, repr(self.options), self.paths, self.obstacles, self.part, self.move),
            *(sorted(self.asked.items(), key=str), self.every, places),
        ]
        sums = hashlib.sha256()
        for each in content:
            sums.update(pickle.dumps(each))
        return sums.hexdigest()

    def try_out(self) -> None:
        """Ask once for next to nothing, which says what is wrong with the question.

        Raises:
            ValueError: As `Solver.solve_path`.
        """
        solver = Solver(self.robot, self.options)
        scene = self.scene(np.eye(4))
        for path in self.paths:
            solver.solve_path(moved_path(path, np.eye(4)), scene, **(self.asked | _SOON))

    def scene(self, T_base_paths: FloatArray) -> _core.Scene | None:
        """Obstacles from a place."""
        shapes, points, contacts = self.obstacles
        if self.move == "base":
            shapes, points = moved_shapes(shapes, T_base_paths), moved_points(points, T_base_paths)
        shapes = [*shapes, *moved_shapes(self.part, T_base_paths)]
        if not shapes and points is None and not contacts:
            return None
        return _core.Scene(shapes, cloud=points, contacts=contacts)

    def ways(self) -> tuple[FloatArray, ...]:
        """Where the tool goes, in the paths' frame."""
        return tuple(way_of(path) for path in self.paths)


def looker(question: Question) -> tuple[Solver, Solver]:
    """Solvers of one thread: of stations that are looked at first, and of paths."""
    options = replace(question.options, max_time=_LOOK_TIME, max_restarts=_LOOK_RESTARTS)
    return Solver(question.robot, options), Solver(question.robot, question.options)


def look(
    question: Question, first: Solver, solver: Solver, place: FloatArray
) -> tuple[int, list[float]]:
    """A place's status and figures."""
    T_base_paths: FloatArray = transform_of(place)
    if question.move == "base":
        T_base_paths = np.asarray(np.linalg.inv(T_base_paths))
    scene = question.scene(T_base_paths)
    paths = [moved_path(path, T_base_paths) for path in question.paths]
    share = _reached(first, paths, scene, question)
    if share < 1.0:
        return STATUSES.index("unreached"), [share, 0.0, *[np.nan] * 4]
    worst, followed = 0, 1.0
    length, clearance, limits, singularity = 0.0, np.inf, np.inf, np.inf
    for path in paths:
        result = solver.solve_path(path, scene, **question.asked)
        worst = max(worst, STATUSES.index(result.status))
        followed = min(followed, _followed(result, len(path)))
        if worst:
            continue
        length += result.length
        clearance = min(clearance, result.clearance)
        limits = min(limits, _to_limits(question.robot, result.q))
        singularity = min(singularity, _to_singularity(solver, path, result))
    if worst:
        return worst, [1.0, followed, *[np.nan] * 4]
    return 0, [1.0, 1.0, length, clearance, limits, singularity]


def _reached(
    solver: Solver, paths: Sequence[Any], scene: _core.Scene | None, question: Question
) -> float:
    """Share of the stations looked at that have an answer of their own."""
    chosen: list[Any] = []
    for path in paths:
        rows = np.unique(np.append(np.arange(0, len(path), question.every), len(path) - 1))
        chosen += [path[k] for k in rows]
    lock = question.asked["lock"]
    if all(isinstance(each, np.ndarray) for each in chosen):
        batch = solver.solve_batch(np.array(chosen), None, scene, 1, lock=lock)
    else:
        batch = solver.solve_batch(chosen, None, scene, 1, lock=lock)
    return float(np.mean(batch.success))


def _followed(result: _core.PathResult, count: int) -> float:
    """The largest share of the stations that one motion meets."""
    if result.success:
        return 1.0
    met = [
        np.floor(result.at[end - 1] + 1e-9) - np.ceil(result.at[first] - 1e-9) + 1
        for first, end in result.pieces
    ]
    met += [np.floor(end.at + 1e-9) for end in result.ends]
    return float(min(max(met, default=0.0), count - 1) / count)


def _to_limits(robot: _core.Robot, q: FloatArray) -> float:
    room = np.minimum(q - robot.lower, robot.upper - q)
    return float(np.where(np.isnan(room), np.inf, room).min())


def _to_singularity(solver: Solver, path: Any, result: _core.PathResult) -> float:
    """The least of stations' distances, or infinity where goals have none."""
    at = np.asarray(result.at)
    rows = np.flatnonzero(np.abs(at - at.round()) < 1e-9)
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), _ROWS)).astype(int))]
    least = np.inf
    for k in rows:
        goal = path[round(float(at[k])) % len(path)]
        try:
            distance = solver.derivatives(goal, result.q[k]).singular_distance
        except ValueError:  # goals that leave too much open
            return np.inf
        if distance is not None and np.isfinite(distance):
            least = min(least, distance)
    return least
