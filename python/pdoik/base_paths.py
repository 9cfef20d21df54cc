"""Paths and obstacles as they are sent and moved: a `Goal` cannot be pickled, and does not move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik.paths import sample_path

FloatArray = npt.NDArray[np.float64]

_GOAL_ARRAYS = ("position_slack", "rotation_slack", "axis", "T_tip_tool")
_GOAL_WORDS = (
    *("type", "weight", "stands", "relative_to", "tip", "soft", "priority"),
    *("position_tolerance", "rotation_tolerance"),
)


def listed(paths: Any) -> list[Any]:
    """Paths, of which one may be given alone."""
    if isinstance(paths, np.ndarray):
        return list(paths) if paths.ndim == 4 else [paths]
    several = list(paths)
    if not several:
        raise ValueError("paths is empty, expected a path or several")
    if isinstance(several[0], _core.Goal) or np.ndim(several[0]) == 2:
        return [several]
    return several


def given_path(path: Any, free: Any, spacing: float | None) -> Any:
    """Poses, (N, 4, 4), or goals in words that can be sent and moved."""
    has_goals = not isinstance(path, np.ndarray) and any(
        isinstance(each, _core.Goal | list) and not _is_matrix(each) for each in path
    )
    if has_goals:
        if free is not None or spacing is not None:
            raise ValueError(
                "free and spacing are for poses, not for goals, which say it themselves"
            )
        return [_given_goals(each) for each in path]
    T = np.asarray(path, dtype=np.float64)
    if T.ndim != 3 or T.shape[1:] != (4, 4):
        raise ValueError(f"a path has shape {T.shape}, expected (N, 4, 4)")
    if spacing is not None:
        T = sample_path(T, spacing)
    if free is None:
        return T
    return [_given_goals(_core.Goal(each, type="axis", axis=free)) for each in T]


def _is_matrix(value: Any) -> bool:
    return isinstance(value, list) and not isinstance(value[0], _core.Goal)


def _given_goals(station: Any) -> list[dict[str, Any]]:
    goals = station if isinstance(station, list) else [station]
    found = []
    for each in goals:
        goal = each if isinstance(each, _core.Goal) else _core.Goal(each, type="pose")
        if goal.type == "center_of_mass":
            raise ValueError("a goal is of the centre of mass, which is in the base's frame")
        words = {name: getattr(goal, name) for name in _GOAL_WORDS}
        arrays = {name: getattr(goal, name) for name in _GOAL_ARRAYS}
        copies = {name: np.array(value) for name, value in arrays.items() if value is not None}
        found.append({"T_base_tip": np.array(goal.T_base_tip), **words, **copies})
    return found


def moved_path(path: Any, T: FloatArray) -> Any:
    """What `given_path` gives, seen from elsewhere, as `Solver.solve_path` takes it."""
    if isinstance(path, np.ndarray):
        return T @ path
    stations = []
    for station in path:
        goals = [
            _core.Goal(
                each["T_base_tip"] if each["relative_to"] is not None else T @ each["T_base_tip"],
                **{name: value for name, value in each.items() if name != "T_base_tip"},
            )
            for each in station
        ]
        stations.append(goals if len(goals) > 1 else goals[0])
    return stations


def way_of(path: Any) -> FloatArray:
    """Where the tool goes, (N, 3) [m]."""
    if isinstance(path, np.ndarray):
        return path[:, :3, 3].copy()
    return np.array([station[0]["T_base_tip"][:3, 3] for station in path])


def given_obstacles(obstacles: Any) -> tuple[Any, ...]:
    """Shapes, points (N, 3) or (N, 4) or None, and rules of contact."""
    shapes: list[_core.Shape] = []
    contacts: list[_core.ContactRule] = []
    if isinstance(obstacles, _core.Scene):
        shapes, contacts, obstacles = obstacles.shapes, obstacles.contacts, obstacles.cloud
    elif (
        isinstance(obstacles, list | tuple) and obstacles and isinstance(obstacles[0], _core.Shape)
    ):
        shapes, obstacles = list(obstacles), None
    points = obstacles.points if isinstance(obstacles, _core.Cloud) else obstacles
    if points is not None:
        points = np.array(points, dtype=np.float64)
        if not points.size:
            points = None
        elif points.ndim != 2 or points.shape[1] not in (3, 4):
            raise ValueError(f"obstacles has shape {points.shape}, expected (N, 3) or (N, 4)")
    return shapes, points, contacts


def moved_shapes(shapes: Sequence[_core.Shape], T: FloatArray) -> list[_core.Shape]:
    """The same, seen from elsewhere."""
    return [shape.moved(T @ shape.T_base_shape) for shape in shapes]


def moved_points(points: FloatArray | None, T: FloatArray) -> FloatArray | None:
    """The same of points, with or without radii."""
    if points is None:
        return None
    moved = points.copy()
    moved[:, :3] = points[:, :3] @ T[:3, :3].T + T[:3, 3]
    return moved
