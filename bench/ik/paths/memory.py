"""What a path of 5,000 stations takes: the growth of a process of its own, at its largest."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import pdoik
from bench.common.intervals import duration
from bench.common.peer_library import ROOT
from bench.ik.experiment import output_of
from bench.ik.lines import Jobs, Line
from bench.ik.paths.arms import ARMS, PLACES
from bench.ik.paths.curves import flat, polyline, stations
from bench.ik.paths.placing import placed, somewhere, tool
from bench.ik.paths.problem import Problem
from bench.ik.paths.solids import Solid, World, frame
from bench.ik.soak.solves import Row

SIZES = (1, 4)  # of each arm, goals by turns
GOALS = ("pose", "axis")
STATIONS = 5_000
ASKED = 500  # [MB]
MEGABYTE = 1 << 10  # [kB]


def jobs(size: int, seed: int) -> Jobs:
    """Each a process."""
    return {
        f"{k:03d}-{arm}": {"index": k, "seed": seed, "arm": arm, "goal": GOALS[(k + j) % 2]}
        for k in range(size)
        for j, arm in enumerate(ARMS)
    }


def draw(arm: str, goal: str, index: int, seed: int) -> Problem:
    """To and fro over a plate, as one paints it."""
    rng = np.random.default_rng([seed, 7, ARMS.index(arm), index])

    def anywhere() -> Problem:
        wide, high = PLACES[arm].size * rng.uniform(0.1, 0.25, 2)
        y = np.repeat(np.linspace(-0.5, 0.5, 12), 2) * high
        x = np.tile([-0.5, 0.5, 0.5, -0.5], 6) * wide
        T = somewhere(rng, arm) @ stations(flat(polyline(np.column_stack([x, y]))), STATIONS)
        floor = Solid(kind="half_space", T=frame([0.0, 0.0, -0.03]))
        return Problem(
            key=f"memory:{arm}:{goal}:{index}:{seed}",
            arm=arm,
            T=T,
            tool=tool(rng),
            free=goal == "axis",
            world=World(solids=[floor] if goal == "axis" else []),
        )

    return placed(anywhere, rng)


def alone(arm: str, goal: str, index: int, seed: int) -> str:
    """Solves one, and says its status, its time and by how much the process grew [MB]."""
    problem = draw(arm, goal, index, seed)
    solver, goals = problem.solver(), problem.goals()
    obstacles = problem.world.given()
    assert isinstance(solver, pdoik.Solver)
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before = _held("VmRSS")
    path: Any = solver
    path = path.solve_path(goals, obstacles, T_tip_tool=problem.tool, max_time=60.0)
    grown = _held("VmHWM") - before
    return f"{path.status} {path.time!r} {grown / MEGABYTE!r}"


def _held(name: str) -> int:
    """Memory of this process [kB]; Linux only."""
    text = Path("/proc/self/status").read_text()
    return int(text.split(f"{name}:")[1].split()[0])


def run_job(job: Mapping[str, Any]) -> list[Row]:
    """One, in a process of its own."""
    arguments = job["arm"], job["goal"], job["index"], job["seed"]
    code = f"from bench.ik.paths.memory import alone; print(alone(*{arguments!r}))"
    said = output_of([sys.executable, "-c", code], "a path of 5,000 stations", cwd=ROOT)
    status, time, grown = said.split()
    return [{**job, "status": status, "time": float(time), "grown": float(grown)}]


def lines(trials: pd.DataFrame) -> list[Line]:
    """The largest."""
    return [
        Line(
            what=f"{STATIONS:,} stations: growth of the process, most",
            asked=f"{ASKED} MB",
            measured=f"{trials.grown.max():.0f} MB, median {trials.grown.median():.0f}; whole "
            f"{int((trials.status == 'whole').sum())}, median {duration(trials.time.median())}, "
            f"most {duration(trials.time.max())}",
            cases=f"{len(trials):,}",
            failures=int((trials.grown > ASKED).sum()),
        )
    ]
