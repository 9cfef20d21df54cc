"""Batches of poses that random configurations reach, by this build and another, in turns.

    python -m bench.ik.hulls.batches panda ur10 iiwa14 --against FOLDER

Some poses are reached by a robot in itself alone: what it takes to give up counts. FOLDER is one
that the other build's `pdoik` is in (`pip install --target FOLDER`), of any version.
"""

import json
import os
import subprocess
import sys
import time
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import pdoik
from bench.common.arrays import FloatArray
from bench.common.markdown import markdown_table
from bench.common.peer_library import ROOT
from bench.ik.experiment import ARMS

Robot = StrEnum("Robot", ARMS)
POSES, BATCHES, POINTS, BUDGET = 1500, 3, 135, 1.0
COLUMNS = ("robot", "scene", "solved, before", "now", "before [s]", "now [s]", "over")


def main(
    robots: Annotated[list[Robot], typer.Argument()],
    against: Annotated[Path | None, typer.Option(help="A folder with another pdoik.")] = None,
    turns: Annotated[int, typer.Option(help="How often each is measured; the median counts.")] = 5,
    measure: Annotated[bool, typer.Option("--measure", hidden=True)] = False,
) -> None:
    """Print the table: the least of three batches, on all processors."""
    if measure:
        print(json.dumps([row for robot in robots for row in _measured(robot)]))
        return
    here = Path(pdoik.__file__).parents[1]
    runs = [[_run(build, robots) for build in (against or here, here)] for _ in range(turns)]
    rows = []
    for k, (robot, scene, solved, _) in enumerate(runs[0][0]):
        before, now = np.median([[run[k][3] for run in turn] for turn in runs], axis=0)
        seconds = (f"{before:.4f}", f"{now:.4f}", f"{now / before:.2f}")
        rows.append((robot, scene, solved, runs[0][1][k][2], *seconds))
    print(markdown_table(COLUMNS, rows))


def _run(build: Path, robots: list[Robot]) -> list[list[Any]]:
    command = [sys.executable, "-m", "bench.ik.hulls.batches", *robots, "--measure"]
    path = os.pathsep.join([str(build), str(ROOT)])
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": path}, check=True, capture_output=True, text=True
    )
    return list(json.loads(done.stdout))


def _measured(name: str) -> list[tuple[str, str, int, float]]:
    """Rows of robot, scene, how many were solved, seconds."""
    robot = pdoik.Robot.builtin(name)
    rng = np.random.default_rng(5)
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    poses = np.stack([robot.fk(q) for q in rng.uniform(low, high, (POSES, robot.dof))])
    points = rng.uniform(-1.0, 1.0, (POINTS, 3))
    points = points[np.linalg.norm(points, axis=1) > 0.5]
    solver = pdoik.Solver(robot, pdoik.Options(max_time=BUDGET))
    rows = []
    for scene, obstacles in (("free", None), (f"{len(points)} points", points)):
        solved, seconds = _least(solver, poses, obstacles)
        rows.append((name, scene, solved, seconds))
    return rows


def _least(
    solver: pdoik.Solver, poses: FloatArray, obstacles: FloatArray | None
) -> tuple[int, float]:
    seconds, solved = np.inf, 0
    for _ in range(BATCHES):
        start = time.perf_counter()
        results = solver.solve_batch(poses, obstacles=obstacles)
        seconds = min(seconds, time.perf_counter() - start)
        solved = int(np.sum(results.success))
    return solved, seconds


if __name__ == "__main__":
    typer.run(main)
