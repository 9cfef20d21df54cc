"""What came of a path, for people and for programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.markup import escape
from rich.table import Table

import pdoik

from .messages import out
from .obstacles import Obstacles
from .tables import angle_text, length_text, time_text

FloatArray = npt.NDArray[np.float64]

_MEANING = {
    "whole": "whole",
    "pieces": "in pieces",
    "impossible": "impossible",
    "not_found": "not found",
    "time_limit": "not found: the time ran out",
}
_COLORS = {"whole": "green", "pieces": "yellow"}
_FAR = 0.6  # clearances beyond it are not measured [m]
_SHOWN = 6  # stations without an answer, pieces


@dataclass(frozen=True, slots=True, kw_only=True)
class PathAnswer:
    """A result together with what it is a result of."""

    robot: pdoik.Robot
    solver: pdoik.Solver
    stations: Any  # as the solver takes them
    places: FloatArray | None  # of them, (N, 3) [m]; None where they are not in the base frame
    result: pdoik.PathResult
    seconds: float  # that it took
    obstacles: Obstacles | None = None
    closed: bool = False
    trajectory: pdoik.Trajectory | None = None
    recheck: Any = None  # of the trajectory

    @property
    def scene(self) -> pdoik.Scene | None:
        return None if self.obstacles is None else self.obstacles.kept()


def print_path(answer: PathAnswer) -> None:
    """A line for what became of it, then figures, then where it breaks."""
    result = answer.result
    color = _COLORS.get(result.status, "red")
    out.print(
        f"[bold {color}]{_MEANING[result.status]}[/]: {escape(result.message)}", highlight=False
    )
    table = Table.grid(padding=(0, 2))
    for name, value, remark in _figures(answer):
        table.add_row(name, value, f"[dim]{escape(remark)}[/]")
    out.print(table, highlight=False)
    for line in _breaks(answer):
        out.print(escape(line), highlight=False)


def _figures(answer: PathAnswer) -> list[tuple[str, str, str]]:
    result, robot = answer.result, answer.robot
    rows: list[tuple[str, str, str]] = []
    if len(result.q):
        is_mixed = "prismatic" in robot.joint_types
        unit = "rad and m" if is_mixed else "rad"
        count = len(answer.stations)
        rows.append(("rows", str(len(result.q)), f"joined by straight lines, of {count} stations"))
        rows.append(
            ("length", f"{result.length:.4g} {unit}", "sum of all joints' ways, row by row")
        )
        if math.isfinite(result.clearance):
            beyond = result.clearance >= _FAR
            text = f"{_FAR:g} m or more" if beyond else length_text(result.clearance)
            wanted = answer.solver.options.clearance
            rows.append(("clearance", text, f"least of all, wanted {length_text(wanted)}"))
        if math.isfinite(result.self_distance):
            rows.append(
                ("between links", length_text(result.self_distance), "least of their hulls")
            )
        step = f"{result.largest_step:.4g} {unit}" if is_mixed else angle_text(result.largest_step)
        rows.append(("largest step", step, "of a joint, from a station to the next"))
        errors = f"{length_text(result.position_error)}, {angle_text(result.rotation_error)}"
        rows.append(("errors", errors, "largest at stations"))
        at, joint = nearest_limit(robot, result.q)
        if joint is not None:
            kind = robot.joint_types[robot.joint_names.index(joint)]
            text = length_text(at) if kind == "prismatic" else angle_text(at)
            rows.append(("to limits", text, f"least, of {joint}"))
    rows.append(("time", time_text(answer.seconds), ""))
    if answer.trajectory is not None:
        rows += _timed(answer.trajectory, answer.recheck)
    return rows


def nearest_limit(robot: pdoik.Robot, q: FloatArray) -> tuple[float, str | None]:
    """How near any row comes to a limit [rad] or [m], and of which joint; None without limits."""
    room = np.minimum(q - robot.lower, robot.upper - q)
    if not room.size or not np.isfinite(room).any():
        return math.inf, None
    room = np.where(np.isfinite(room), room, np.inf)
    column = int(np.argmin(room.min(axis=0)))
    return float(room[:, column].min()), robot.joint_names[column]


def _timed(trajectory: pdoik.Trajectory, recheck: Any) -> list[tuple[str, str, str]]:
    rows = [("motion", f"{trajectory.duration:.4g} s", f"{len(trajectory.time)} samples")]
    if trajectory.dips:
        slowest = min(trajectory.dips, key=lambda dip: dip.speed)
        what = f"{slowest.limit} of {slowest.joint}" if slowest.joint else slowest.limit
        rows.append(
            (
                "slower",
                f"in {len(trajectory.dips)} places",
                f"least {slowest.speed:.3g} m/s at {slowest.start:.2f} s: {what}",
            )
        )
    if recheck is not None and not recheck.success:
        remark = f"at {recheck.time:.2f} s: {recheck.worst.worst_constraint}"
        rows.append(("timed motion", "NOT clear", remark))
    return rows


def _breaks(answer: PathAnswer) -> list[str]:
    result = answer.result
    if result.success:
        return []
    lines = [
        f"breaks at station {end.at:.2f}{_place(answer, end.at)}: {end.reason}"
        for end in result.ends
    ]
    unsolved = list(result.unsolved)
    if unsolved:
        shown = ", ".join(str(k) for k in unsolved[:_SHOWN])
        more = f" and {len(unsolved) - _SHOWN} more" if len(unsolved) > _SHOWN else ""
        lines.append(f"no solution was found at station {shown}{more}")
    for k, (first, end_row) in enumerate(result.pieces):
        lines.append(
            f"piece {k + 1}: from station {result.at[first]:.2f} to {result.at[end_row - 1]:.2f},"
            f" rows {first} to {end_row - 1}"
        )
        if k < len(result.moves):
            corners = len(result.moves[k])
            how = f"a clear move of {corners} corners" if corners else "no move was found"
            lines.append(f"  to the next: {how}")
    if result.status == "time_limit":
        lines.append("try a longer --max-time")
    elif not result.complete:
        lines.append("not all solutions of its stations are known, so there may be a whole motion")
    return lines


def _place(answer: PathAnswer, at: float) -> str:
    """Where in space a place of the path is."""
    if answer.places is None:
        return ""
    places = answer.places
    count = len(places)
    k = min(int(at), count - 1)
    other = (k + 1) % count if answer.closed else min(k + 1, count - 1)
    place = places[k] + (at - k) * (places[other] - places[k])
    return " ({:.3f} {:.3f} {:.3f})".format(*place)


_FIGURES = (  # of a result
    *("success", "status", "message", "length", "clearance", "self_distance", "largest_step"),
    *("position_error", "rotation_error", "unsolved", "complete", "time", "q", "at", "pieces"),
    "moves",
)


def path_facts(answer: PathAnswer) -> dict[str, object]:
    """Everything in an answer, for JSON; SI units."""
    result, robot = answer.result, answer.robot
    ends = [{"at": end.at, "q": end.q, "reason": end.reason} for end in result.ends]
    timed = answer.trajectory
    return {
        "robot": robot.name,
        "base_link": robot.base_link,
        "tip_links": list(robot.tip_links),
        "joint_names": list(robot.joint_names),
        "stations": len(answer.stations),
        **{name: getattr(result, name) for name in _FIGURES},
        "ends": ends,
        "limit_distance": nearest_limit(robot, result.q)[0],
        "duration": None if timed is None else timed.duration,
        "dips": None if timed is None else len(timed.dips),
        "timed_is_clear": None if answer.recheck is None else answer.recheck.success,
    }


def places_of(stations: Any) -> FloatArray | None:
    """Where stations are, (N, 3) [m], if all are places in the base frame."""
    if isinstance(stations, np.ndarray):
        return np.asarray(stations[:, :3, 3])
    found = []
    for station in stations:
        goals: Sequence[pdoik.Goal] = station if isinstance(station, list) else [station]
        placed = [
            goal for goal in goals
            if goal.relative_to is None and goal.type not in ("look_at", "center_of_mass")
        ]  # fmt: skip
        if not placed:
            return None
        found.append(placed[0].T_base_tip[:3, 3])
    return np.array(found)
