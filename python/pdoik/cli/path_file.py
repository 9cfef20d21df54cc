"""A path from a file: .csv with a row for each station or corner, or .yaml with a list of goals.

The first row of a table names its columns: x y z [m], and one of
- qx qy qz qw: a quaternion, by name, in any order;
- roll pitch yaw [rad], as in URDF;
- ax ay az: where the tool's axis points; the tool may turn about it.
Other columns are passed over, and so are lines that begin with #.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik.scenes import EntryError, read_text

from .goal_file import read_station_file, turn_onto
from .messages import tell, warn, warn_of_degrees
from .target import rotation_of_rpy, rotation_of_xyzw

FloatArray = npt.NDArray[np.float64]

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_PLACE = ("x", "y", "z")
_TURNS = (("qx", "qy", "qz", "qw"), ("roll", "pitch", "yaw"), ("ax", "ay", "az"))
_SUFFIXES = {".csv", ".txt", ".yaml", ".yml"}
_FARTHEST_LIKELY = 20.0  # [m]
_JUMP, _TIMES_USUAL = 0.2, 20.0  # a step this long, and so many times the usual one [m]
_SAME = 1e-9  # stations that differ by less are one


@dataclass(frozen=True, slots=True, kw_only=True)
class PathFile:
    """What a file says of a path.

    Attributes:
        poses: Stations or corners, (N, 4, 4) [m]; None where there are other goals.
        is_axis: Whether of their turn only the tool's axis counts.
        goals: The goals of each station, where these are not poses.
    """

    poses: FloatArray | None = None
    is_axis: bool = False
    goals: list[list[pdoik.Goal]] | None = None

    def stations(self, axis: str | None, spacing: float | None) -> Any:
        """Stations as `Solver.solve_path` takes them: poses (N, 4, 4), or a list of goals.

        Args:
            axis: Of the tool, that it may turn about.
            spacing: Poses are corners, and stations on straight lines between them [m].

        Raises:
            ValueError: axis or spacing is given for goals, or the spacing is not positive.
        """
        if self.poses is None:
            for name, value in (("--free", axis), ("--spacing", spacing)):
                if value is not None:
                    raise ValueError(
                        f"{name}: expected poses; these are goals, which say it themselves"
                    )
            assert self.goals is not None
            return [each if len(each) > 1 else each[0] for each in self.goals]
        T = self.poses if spacing is None else pdoik.sample_path(self.poses, spacing)
        if axis is None and not self.is_axis:
            return T
        return [pdoik.Goal(each, type="axis", axis=axis or "z") for each in T]


def read_path_file(path: Path, axis: str | None = None) -> PathFile:
    """The path in a file.

    Args:
        path: .csv (or .txt with the same content), .yaml or .yml.
        axis: Of the tool, which the columns ax ay az are about; None for z.

    Raises:
        LoadError: Names the file, the line and the column, or the entry, and what was expected.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise EntryError(path, "expected a name that ends in .csv, .yaml or .yml")
    if path.suffix.lower() in (".yaml", ".yml"):
        listed = read_station_file(path)
        if len(listed) < 2:
            raise EntryError(path, "expected at least two stations, got one")
        poses = _plain_poses(listed)
        return PathFile(goals=listed) if poses is None else PathFile(poses=poses)
    return _read_table(path, axis or "z")


def _plain_poses(listed: Sequence[Sequence[pdoik.Goal]]) -> FloatArray | None:
    """The targets of stations that are poses and no more than that."""
    for goals in listed:
        goal = goals[0]
        if len(goals) > 1 or goal.type != "pose" or goal.soft:
            return None
        says = (goal.tip, goal.relative_to, goal.T_tip_tool, goal.priority)
        if any(each is not None for each in says):
            return None
        if goal.position_tolerance or goal.rotation_tolerance:
            return None
        if np.any(goal.position_slack) or np.any(goal.rotation_slack):
            return None
    return np.array([goals[0].T_base_tip for goals in listed])


def _read_table(path: Path, axis: str) -> PathFile:
    reader = csv.reader(read_text(path).removeprefix("\ufeff").splitlines(), skipinitialspace=True)
    try:
        rows = [(reader.line_num, [word.strip() for word in row]) for row in reader]
    except csv.Error as error:
        raise EntryError(path, str(error), f"line {reader.line_num}") from error
    rows = [row for row in rows if any(row[1]) and not row[1][0].startswith("#")]
    if not rows:
        raise EntryError(path, "is empty, expected a first row that names the columns")
    line, words = rows.pop(0)
    names = [word.lower() for word in words]
    turn = _turn_of(path, line, names)
    wanted = (*_PLACE, *turn)
    table = np.array([_numbers(path, line, words, names, wanted) for line, words in rows])
    if len(table) < 2:
        raise EntryError(path, f"expected at least two stations, got {len(table)}")
    lines = [line for line, _ in rows]
    poses = np.tile(np.eye(4), (len(table), 1, 1))
    poses[:, :3, 3] = table[:, :3]
    if turn[0] == "ax":
        poses[:, :3, :3] = _along(path, lines, table[:, 3:], np.array(AXES[axis]))
    elif turn[0] == "roll":
        warn_of_degrees(f"{path}: roll pitch yaw", table[:, 3:].ravel())
        poses[:, :3, :3] = [rotation_of_rpy(*angles) for angles in table[:, 3:]]
    else:
        for T, line, xyzw in zip(poses, lines, table[:, 3:], strict=True):
            try:
                T[:3, :3] = rotation_of_xyzw(xyzw)
            except ValueError as error:
                raise EntryError(path, str(error), f"line {line}: columns qx to qw") from error
    poses = _without_repeats(path, lines, poses)
    _warn_of_places(path, poses[:, :3, 3])
    return PathFile(poses=poses, is_axis=turn[0] == "ax")


def _turn_of(path: Path, line: int, names: list[str]) -> tuple[str, ...]:
    """The columns that a table has of the tool's turn."""
    options = "; ".join(" ".join(each) for each in _TURNS)
    expected = f"expected the columns x y z and one of: {options}"
    known = [*_PLACE, *(name for each in _TURNS for name in each)]
    for k, name in enumerate(names):
        if name in known and names.index(name) < k:
            raise EntryError(
                path, f"{expected}; {name} is there twice", f"line {line}: column {k + 1}"
            )
    if missing := [name for name in _PLACE if name not in names]:
        raise EntryError(path, f"{expected}; there is no {' '.join(missing)}", f"line {line}")
    begun = [each for each in _TURNS if set(each) & set(names)]
    if len(begun) != 1:
        got = " and ".join(" ".join(each) for each in begun) or "none of these"
        raise EntryError(path, f"{expected}; got {got}", f"line {line}")
    (turn,) = begun
    if missing := [name for name in turn if name not in names]:
        raise EntryError(path, f"{expected}; there is no {' '.join(missing)}", f"line {line}")
    over = [name or "one without a name" for name in names if name not in (*_PLACE, *turn)]
    if over:
        tell(f"{path}: passed over the columns {', '.join(over)}")
    return turn


def _numbers(
    path: Path, line: int, words: list[str], names: list[str], wanted: Sequence[str]
) -> list[float]:
    if len(words) != len(names):
        what = f"expected {len(names)} columns, as the first row has, got {len(words)}"
        raise EntryError(path, what, f"line {line}")
    found = []
    for name in wanted:
        k = names.index(name)
        try:
            value = float(words[k])
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            what = f"expected a finite number, got {words[k]!r}"
            raise EntryError(path, what, f"line {line}: column {k + 1} ({name})")
        found.append(value)
    return found


def _along(path: Path, lines: list[int], directions: FloatArray, axis: FloatArray) -> FloatArray:
    """Turns, (N, 3, 3), that bring the tool's axis to directions with the least twist."""
    R = np.eye(3)
    turns = []
    at = axis
    for line, vector in zip(lines, directions, strict=True):
        length = float(np.linalg.norm(vector))
        if length < 1e-9:
            what = "expected a direction, got one of no length"
            raise EntryError(path, what, f"line {line}: columns ax to az")
        R = turn_onto(at, vector / length) @ R
        at = R @ axis
        turns.append(R)
    return np.array(turns)


def _without_repeats(path: Path, lines: list[int], poses: FloatArray) -> FloatArray:
    moves = np.abs(np.diff(poses, axis=0)).max(axis=(1, 2)) > _SAME
    kept = np.append(True, moves)
    if not kept.all():
        repeats = [str(line) for line, keep in zip(lines, kept, strict=True) if not keep]
        more = f" and {len(repeats) - 5} more" if len(repeats) > 5 else ""
        warn(f"{path}: left out what repeats the row before: line {', '.join(repeats[:5])}{more}")
    if kept.sum() < 2:
        raise EntryError(path, "expected at least two stations, got the same one again and again")
    left: FloatArray = poses[kept]
    return left


def _warn_of_places(path: Path, places: FloatArray) -> None:
    farthest = float(np.abs(places).max())
    if farthest > _FARTHEST_LIKELY:
        warn(f"{path} has places up to {farthest:.0f} m away: are they millimetres?")
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    usual = float(np.median(steps))
    k = int(np.argmax(steps))
    if len(steps) > 4 and steps[k] > max(_JUMP, _TIMES_USUAL * usual):
        warn(
            f"{path}: from station {k} to {k + 1} it goes {steps[k]:.3g} m, elsewhere"
            f" {usual:.2g} m: the tool goes straight there; are stations missing?"
        )
