"""What pdoik path writes: joint positions by place, or by time."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import pdoik
from pdoik._files import write_whole

from .messages import fail

FloatArray = npt.NDArray[np.float64]

_DEVIATIONS = (1e-4, 1e-5)  # from the straight lines, the next where one is not clear [rad] or [m]


def check_out(file: Path | None, is_timed: bool) -> None:
    """Leave with status 2 where it cannot be written."""
    if file is None:
        return
    if file.suffix.lower() not in (".csv", ".yaml", ".yml"):
        fail(f"--out: expected a name that ends in .csv, .yaml or .yml, got {file.name!r}")
    if file.suffix.lower() != ".csv" and not is_timed:
        fail("--out: a trajectory has times, give --acceleration (and --speed); or a name in .csv")
    if not file.parent.is_dir():
        fail(f"--out: there is no folder {file.parent}")


def timed(
    robot: pdoik.Robot,
    solver: pdoik.Solver,
    result: pdoik.PathResult,
    scene: Any,
    how: dict[str, Any],
    tool: dict[str, Any],
) -> tuple[pdoik.Trajectory, Any]:
    """A trajectory of pieces and moves, at rest where they meet, and its check.

    Args:
        robot: Whose joints they are.
        solver: That judges it.
        result: With a move after each piece but the last.
        scene: Obstacles.
        how: Of `time_path`, for all of it.
        tool: The same of the pieces only: moves are as fast as joints can.

    Raises:
        ValueError: As `time_path`.
        PdoikError: As `time_path`.
    """
    for deviation in _DEVIATIONS:
        parts = []
        for k, (first, end) in enumerate(result.pieces):
            q, at = result.q[first:end], result.at[first:end]
            if end - first > 1:
                parts.append(pdoik.time_path(robot, q, at=at, deviation=deviation, **how, **tool))
            if k < len(result.moves):
                corners = result.moves[k]
                places = np.linspace(at[-1], max(at[-1], result.at[end]), len(corners))
                move = pdoik.time_path(robot, corners, at=places, deviation=deviation, **how)
                parts.append(move)
        whole = _joined(parts)
        recheck = whole.recheck(solver, scene)
        if recheck.success:
            break
    return whole, recheck


def _joined(parts: list[pdoik.Trajectory]) -> pdoik.Trajectory:
    """One after the other, each from rest to rest."""
    from dataclasses import replace

    starts = np.append(0.0, np.cumsum([part.duration for part in parts]))
    arrays = {
        name: np.concatenate([getattr(part, name)[k > 0 :] for k, part in enumerate(parts)], axis=0)
        for name in ("q", "dq", "ddq", "at")
    }
    time = [part.time[k > 0 :] + starts[k] for k, part in enumerate(parts)]
    dips = [
        replace(dip, start=dip.start + starts[k], end=dip.end + starts[k])
        for k, part in enumerate(parts)
        for dip in part.dips
    ]
    return pdoik.Trajectory(
        joint_names=parts[0].joint_names,
        time=np.concatenate(time),
        dips=tuple(dips),
        deviation=max(part.deviation for part in parts),
        **arrays,
    )


def write_rows(file: Path, robot: pdoik.Robot, result: pdoik.PathResult) -> None:
    """A row for each configuration: place, piece, and joints; in moves the piece is empty.

    Replaces a file only when all is written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["at", "piece", *(f"q.{name}" for name in robot.joint_names)])
    for k, (first, end) in enumerate(result.pieces):
        for at, q in zip(result.at[first:end], result.q[first:end], strict=True):
            writer.writerow([float(at), k, *q.tolist()])
        if k < len(result.moves):
            corners = result.moves[k]
            places = np.linspace(result.at[end - 1], result.at[end], max(len(corners), 1))
            for at, q in zip(places[1:-1], corners[1:-1], strict=True):
                writer.writerow([float(at), "", *q.tolist()])
    write_whole(file, text.getvalue())


def write_trajectory(file: Path, trajectory: pdoik.Trajectory) -> None:
    """Write it as CSV or as YAML, by the file's name."""
    if file.suffix.lower() == ".csv":
        trajectory.to_csv(file)
    else:
        trajectory.to_yaml(file)
