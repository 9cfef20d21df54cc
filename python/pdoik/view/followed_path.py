"""A whole path that the robot follows: how it is played, coloured and marked."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik

from .log import Log

FloatArray = npt.NDArray[np.float64]
Scene = pdoik.Scene | pdoik.Cloud | None

_STEP = 0.05  # of a joint in a move, from one look to the next [rad] or [m]
_SHARE = 0.1  # of joints' speed limits, at which it is played
_USUAL = 1.0  # where they have none [rad/s] or [m/s]
_NO_PLACE = ("look_at", "center_of_mass")


@dataclass(frozen=True, slots=True, kw_only=True)
class Break:
    """Where a motion along the path ends, and against what."""

    place: FloatArray  # of the tool, (3,) [m]
    text: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedPath:
    """What came of a path, with all that the page shows of it."""

    result: pdoik.PathResult
    log: Log | None  # to be played, moves between pieces too; None where there is no row
    lines: FloatArray  # of each tip, through all rows, (tips, T, 3) [m]
    room: FloatArray  # of each row to obstacles, or among links if there are none, (T,) [m]
    is_move: npt.NDArray[np.bool_]  # whether what leads to the row is no part of the path, (T,)
    asked: FloatArray  # where the stations are, (N, 3), or none of them [m]
    unsolved: FloatArray  # where those without a solution are, (K, 3) [m]
    breaks: tuple[Break, ...]


def follow_path(
    name: str,
    solver: pdoik.Solver,
    stations: Any,
    obstacles: pdoik.Scene | FloatArray,
    **asked: Any,
) -> FollowedPath:
    """Find the motion, and judge each row of it.

    Args:
        name: Of the path.
        solver: Of the robot.
        stations: As `pdoik.Solver.solve_path` takes them.
        obstacles: A scene, or points, (K, 4) [m].
        **asked: As there.

    Raises:
        ValueError: As there.
    """
    scene: Scene = obstacles if isinstance(obstacles, pdoik.Scene) else None
    if isinstance(obstacles, np.ndarray) and len(obstacles):
        scene = pdoik.Cloud(obstacles)  # taken in once
    result = solver.solve_path(stations, scene, **asked)
    robot, tool = solver.robot, np.array(solver.options.T_tip_tool)
    q, at, is_move = _played(result)
    verdicts = [_judged(solver, each, scene) for each in q]
    clearance = np.array([each.clearance for each in verdicts])
    among = np.array([each.self_distance for each in verdicts])
    room = np.where(np.isfinite(clearance), clearance, among)
    places = station_places(stations)
    lines = [[(robot.fk(each, tip) @ tool)[:3, 3] for each in q] for tip in robot.tip_links]
    tip = robot.tip_links[0]
    return FollowedPath(
        result=result,
        log=_log(name, robot, result, q, _notes(at, is_move, room)) if len(q) else None,
        lines=np.array(lines).reshape(len(robot.tip_links), -1, 3),
        room=room,
        is_move=is_move,
        asked=places,
        unsolved=places[list(result.unsolved)] if len(places) else places,
        breaks=tuple(
            Break(
                place=(robot.fk(end.q, tip) @ tool)[:3, 3],
                text=f"breaks at station {end.at:.1f}: {end.reason}",
            )
            for end in result.ends
            if len(end.q)
        ),
    )


def station_places(stations: Any) -> FloatArray:
    """Where stations are, (N, 3); (0, 3) if any of them is no place in the base frame."""
    if isinstance(stations, np.ndarray):
        return np.array(stations[:, :3, 3], dtype=np.float64)
    found = []
    for station in stations:
        goals = station if isinstance(station, list) else [station]
        placed = [
            np.asarray(goal.T_base_tip)[:3, 3] if isinstance(goal, pdoik.Goal) else goal[:3, 3]
            for goal in goals
            if not isinstance(goal, pdoik.Goal)
            or (goal.relative_to is None and goal.type not in _NO_PLACE)
        ]
        if not placed:
            return np.empty((0, 3))
        found.append(placed[0])
    return np.array(found, dtype=np.float64)


def _played(
    result: pdoik.PathResult,
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_]]:
    """Rows of pieces and of moves between them, their places on the path, and which are moves."""
    q, at, is_move = [], [], []
    for k, (first, end) in enumerate(result.pieces):
        q += list(result.q[first:end])
        at += result.at[first:end].tolist()
        is_move += [k > 0, *[False] * (end - first - 1)]
        if k < len(result.moves):
            for a, b in pairwise(result.moves[k]):
                parts = max(1, int(np.ceil(np.abs(b - a).max() / _STEP)))
                q += [a + (b - a) * part / parts for part in range(1, parts + 1)]
                at += [float(result.at[end - 1])] * parts
                is_move += [True] * parts
    n = result.q.shape[1] if result.q.ndim == 2 else 0
    return np.array(q).reshape(-1, n), np.array(at), np.array(is_move, dtype=bool)


def _judged(solver: pdoik.Solver, q: FloatArray, scene: Scene) -> pdoik.Result:
    robot = solver.robot
    tip = robot.tip_links[0]
    target: Any = {tip: robot.fk(q, tip)} if len(robot.tip_links) > 1 else robot.fk(q)
    return solver.judge(target, q, scene, T_tip_tool=np.eye(4))


def _notes(at: FloatArray, is_move: npt.NDArray[np.bool_], room: FloatArray) -> tuple[str, ...]:
    def note(place: float, moves: bool, left: float) -> str:
        where = f"a move after station {place:.1f}" if moves else f"station {place:.1f}"
        return f"{where}, {1e3 * left:.1f} mm of room" if np.isfinite(left) else where

    return tuple(map(note, at.tolist(), is_move.tolist(), room.tolist()))


def _log(
    name: str,
    robot: pdoik.Robot,
    result: pdoik.PathResult,
    q: FloatArray,
    notes: tuple[str, ...],
) -> Log:
    """Log to be played at a share of the joints' speeds."""
    limits = np.where(np.isfinite(robot.velocity) & (robot.velocity > 0), robot.velocity, _USUAL)
    steps = (np.abs(np.diff(q, axis=0)) / (_SHARE * limits)).max(axis=1)
    time = np.append(0.0, np.cumsum(np.maximum(steps, 1e-4)))
    said = "\n\n".join([result.message, *(_said(end) for end in result.ends)])
    return Log(
        name=name,
        time=time,
        signals={"q": q},
        object_pose=None,
        expected=said,
        row_notes=notes,
    )


def _said(end: pdoik.PathEnd) -> str:
    return f"Breaks at station {end.at:.1f}: {end.reason}."
