"""Whole paths of a tool: from corners or stations to one motion."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pdoik import _core
from pdoik._rotations import rotation_of, rotation_vector
from pdoik.options import Options
from pdoik.solver import Solver

FloatArray = npt.NDArray[np.float64]

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def sample_path(
    corners: npt.ArrayLike, spacing: float = 0.005, turn_spacing: float = 0.035
) -> FloatArray:
    """Stations along the straight lines between corners, turning evenly from one to the next.

    Args:
        corners: Poses of the tool, shape (N, 4, 4) [m].
        spacing: How far a station is from the next, at most [m].
        turn_spacing: How far it is turned, at most [rad].

    Returns:
        The stations, corners among them, shape (M, 4, 4).

    Raises:
        ValueError: Another shape, fewer than two corners, NaN, a spacing that is not positive.
    """
    T = np.asarray(corners, dtype=float)
    if T.ndim != 3 or T.shape[1:] != (4, 4) or len(T) < 2:
        raise ValueError(f"corners has shape {T.shape}, expected (N, 4, 4) with N of at least 2")
    if not np.isfinite(T).all():
        raise ValueError("corners holds NaN or infinity")
    for name, value in (("spacing", spacing), ("turn_spacing", turn_spacing)):
        if not value > 0:
            raise ValueError(f"{name} is {value}, expected a positive number")
    stations = [T[0]]
    for one, other in itertools.pairwise(T):
        vector = rotation_vector(one[:3, :3].T @ other[:3, :3])
        offset = other[:3, 3] - one[:3, 3]
        pieces = max(
            int(np.ceil(np.linalg.norm(offset) / spacing - 1e-9)),
            int(np.ceil(np.linalg.norm(vector) / turn_spacing - 1e-9)),
        )
        for share in np.arange(1, pieces) / max(pieces, 1):
            station = np.eye(4)
            station[:3, :3] = one[:3, :3] @ rotation_of(share * vector)
            station[:3, 3] = one[:3, 3] + share * offset
            stations.append(station)
        if pieces > 0:
            stations.append(other)
    return np.array(stations)


def solve_path(
    robot: _core.Robot | Solver,
    path: Any,
    obstacles: Any = None,
    *,
    free: Literal["x", "y", "z"] | Sequence[float] | None = None,
    spacing: float | None = None,
    tip: str | None = None,
    options: Options | None = None,
    **asked: Any,
) -> _core.PathResult:
    """Follow a whole path as one question: a seam, a spray path, a scan.

    Args:
        robot: Who follows it; or a solver, with what is attached to it.
        path: Poses of the tool, shape (N, 4, 4) [m], or a list of goals as `Solver.solve_path`
            takes them.
        obstacles: As in `Solver.solve`.
        free: The axis of the tool that it may turn about, by name or as a vector in its frame.
        spacing: How far stations are apart at most: poses are then corners, and the stations are
            on the straight lines between them, see `sample_path` [m].
        tip: The tip link, where the robot has several.
        options: Of the solver; None for those a robot has by default.
        **asked: All else that `Solver.solve_path` takes: start, end, closed, costs, ...

    Raises:
        ValueError: As in `Solver.solve_path` and `sample_path`; free or spacing with goals.
    """
    solver = robot if isinstance(robot, Solver) else Solver(robot, options)
    is_list = isinstance(path, list | tuple) and any(isinstance(p, _core.Goal | list) for p in path)
    if is_list and np.shape(path[0])[:1] != (4,):
        if free is not None or spacing is not None:
            raise ValueError(
                "free and spacing are for poses, not for goals, which say it themselves"
            )
        return solver.solve_path(path, obstacles, **asked)
    stations = np.asarray(path, dtype=float)
    if spacing is not None:
        stations = sample_path(stations, spacing)
    if free is None and tip is None:
        return solver.solve_path(stations, obstacles, **asked)
    if stations.ndim != 3:
        raise ValueError(f"path has shape {stations.shape}, expected (N, 4, 4)")
    more: dict[str, Any] = {} if tip is None else {"tip": tip}
    if isinstance(free, str):
        if free not in _AXES:
            raise ValueError(f"free is '{free}', expected 'x', 'y', 'z' or a vector")
        more |= {"type": "axis", "axis": _AXES[free]}
    elif free is not None:
        more |= {"type": "axis", "axis": free}
    goals = [_core.Goal(T, **more) for T in stations]
    return solver.solve_path(goals, obstacles, **asked)
