"""Deadlines: by how much calls outlast their budget, by the wall's clock and by the processor's.

    python -m bench.ik.deadlines --out build/bench/deadlines

Calls are timed inside C++ (deadline_calls), without the cloud's intake, which has its own column.
Besides the idle machine, other programs keep one processor busy, then two. --quick takes a minute.
"""

import hashlib
import io
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import pandas as pd
import typer
from rich.progress import track

from bench.common import commands
from bench.common.campaign import Campaign
from bench.common.peer_library import build
from bench.ik.deadlines.clouds import KINDS, write_cloud
from bench.ik.deadlines.python import CALL, Effort, python_calls
from bench.ik.deadlines.tables import all_tables
from bench.ik.experiment import output_of, tell

ROBOTS = ("panda", "h1")
BUDGETS = (0.0002, 0.001, 0.005)  # [s]
USUAL_BUDGET = 0.001
TRACKER_BUDGET = 0.0008  # of a period of 1 ms
COUNTS = (0, 1_000, 10_000, 100_000, 1_000_000)
QUICK_COUNTS = (0, 1_000, 100_000)
LOADS = (0, 1, 2)  # processors that other programs keep busy


class Cell(NamedTuple):
    """What calls of one kind are timed on."""

    robot: str
    call: str  # LM, lbfgs or paper of Solver, or tracker
    budget: float  # [s]
    cloud: str  # one of KINDS
    points: int
    load: int

    @property
    def name(self) -> str:
        """Good for a file."""
        return "-".join(map(str, self._replace(budget=f"{1e6 * self.budget:.0f}us")))


Plan = Sequence[tuple[str, float, Sequence[int]]]  # calls, their budgets [s], loads

# Other programs run next to the default method and the tracker only.
PLAN: Plan = (
    *(("LM", budget, LOADS) for budget in BUDGETS),
    ("tracker", TRACKER_BUDGET, LOADS),
    *((call, USUAL_BUDGET, LOADS[:1]) for call in ("lbfgs", "paper")),
)
QUICK_PLAN: Plan = (
    ("LM", USUAL_BUDGET, LOADS[:2]),
    ("tracker", TRACKER_BUDGET, LOADS[:2]),
)


def cells(plan: Plan, robots: Sequence[str], counts: Sequence[int]) -> list[Cell]:
    """All that the tables show, load by load."""
    return [
        Cell(robot, call, budget, cloud, count, load)
        for load in LOADS
        for robot in robots
        for call, budget, loads in plan
        for count in counts
        for cloud in (KINDS if count else KINDS[:1])
        if load in loads
    ]


def main(
    out: commands.OutFolder = commands.BUILD / "deadlines",
    quick: commands.Quick = False,
    repeats: Annotated[
        int, typer.Option(min=1, help="Calls of each kind of goal, where the time suffices.")
    ] = 500,
    seconds: Annotated[
        float, typer.Option(help="For each kind of goal at most; three calls at least.")
    ] = 0.6,
    robot: Annotated[list[str] | None, typer.Option(help="panda and h1 otherwise.")] = None,
    count: Annotated[
        list[int] | None, typer.Option(help="Points; 0 to a million otherwise.")
    ] = None,
    seed: commands.Seed = 0,
    build_folder: commands.BuildFolder = commands.BUILD,
) -> None:
    """Measure how well deadlines are kept."""
    robots, counts = tuple(robot or ROBOTS), tuple(count or (QUICK_COUNTS if quick else COUNTS))
    if quick:
        repeats, seconds, out = min(repeats, 50), 0.02, out.with_name(out.name + "-quick")
    with commands.plain_errors():
        with commands.console.status("building"):
            program = build(build_folder, "pdoik_deadlines") / "bench" / "pdoik_deadlines"
        settings = {
            "experiment": "deadlines",
            "program": hashlib.sha256(program.read_bytes()).hexdigest()[:16],
            "repeats": repeats,
            "seconds": seconds,
            "seed": seed,
        }
        calls = measured(
            Campaign(out, settings),
            program,
            cells(QUICK_PLAN if quick else PLAN, robots, counts),
            Effort(repeats=repeats, seconds=seconds, seed=seed),
        )
        tell(out, all_tables(calls, seed), name="deadlines")


def measured(
    campaign: Campaign, program: Path, plan: Sequence[Cell], effort: Effort
) -> pd.DataFrame:
    """All calls of all cells, a row each; times in seconds, without the intake."""
    with tempfile.TemporaryDirectory(prefix="pdoik-deadlines-") as folder:
        kinds = {(cell.cloud, cell.points) for cell in plan}
        clouds = {kind: write_cloud(Path(folder), *kind, effort.seed) for kind in sorted(kinds)}
        for load in LOADS:
            left = [cell for cell in plan if cell.load == load and not campaign.has(cell.name)]
            with busy_processors(load):
                for cell in track(left, f"beside {load}", console=commands.console, transient=True):
                    cloud = clouds[cell.cloud, cell.points]
                    campaign.keep(cell.name, calls_of(program, cell, cloud, effort))
        calls = campaign.gather([cell.name for cell in plan])
        return pd.concat([calls, *from_python(calls, clouds, effort)], ignore_index=True)


def from_python(
    calls: pd.DataFrame, clouds: Mapping[tuple[str, int], Path | None], effort: Effort
) -> Iterator[pd.DataFrame]:
    """The calls from Python among each cloud, whose intake C++ has timed by the thread's clock."""
    for (kind, count), cloud in clouds.items():
        same = calls[(calls.cloud == kind) & (calls.points == count) & (calls.load == 0)]
        timed = python_calls(cloud, USUAL_BUDGET, same.intake_cpu.median(), effort)
        facts = {"robot": "panda", "call": CALL, "budget": USUAL_BUDGET, "cloud": kind}
        yield timed.assign(**facts, points=count, load=0, case="random")


def calls_of(program: Path, cell: Cell, cloud: Path | None, effort: Effort) -> pd.DataFrame:
    """The calls of one cell."""
    words = (program, cell.robot, cell.call, cloud or "none", cell.budget)
    words += (effort.repeats, effort.seconds, effort.seed)
    raw = pd.read_csv(io.StringIO(output_of(words, cell.name)))
    # What a result states of its intake counts, too, where some of it is put off until the call.
    put_off = (raw.stated_intake - raw.intake_wall).clip(lower=0)
    wall = 1e-9 * (raw.wall - put_off)
    return raw[["case", "late", "evaluations"]].assign(
        **cell._asdict(),
        intake=1e-9 * np.maximum(raw.intake_wall, raw.stated_intake),
        intake_cpu=1e-9 * (raw.intake_cpu + put_off),
        wall=wall,
        cpu=1e-9 * (raw.cpu - put_off),
        # Ended by the deadline, whatever status the outcome got.
        struck=(raw.struck == 1) | (wall >= cell.budget),
    )


@contextmanager
def busy_processors(count: int) -> Iterator[None]:
    """So many programs that do nothing but run."""
    programs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


if __name__ == "__main__":
    typer.run(main)
