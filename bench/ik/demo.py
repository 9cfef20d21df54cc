"""The demo: three arms reach targets among random clutter, and every success is checked again.

    bash bench/demo.sh [--targets 200] [--leaf 0.02] [--ycb DIR] [--out FILE.png]

For each arm and target: a random posture defines the target (so it can be reached), 1 to 9 objects
are placed at random so that the posture is clear of their scan, and the solver finds a posture for
the target from the middle of the joint ranges. It is given the whole scan, or with --leaf balls
that hold the whole scan. Solved is what plain NumPy finds at the target, within the limits and
clear of every point of the scan.
"""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

import pdoik
from bench.common.arrays import FloatArray
from bench.common.descriptions import shipped
from bench.ik.judges.recheck import UrdfChain, Verdict, recheck
from bench.ik.scenes.objects import (
    ObjectModel,
    Scene,
    SceneError,
    primitive_models,
    random_scene,
    ycb_models,
)
from pdoik.picture import draw_solution

ROBOTS = ("panda", "ur10", "iiwa14")
LEAST_SOLVED = 0.99
PICTURE = Path(__file__).resolve().parents[2] / "build" / "bench" / "demo.png"
_SHOWN_CLEARANCE = 0.005  # of the posture drawn, where there is one [m]
_SHOWN_HEIGHT = 0.2  # of its target: the scenes have no floor, but readers expect one [m]
console = Console(soft_wrap=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """One target: what was asked, what came out, and what the second check says."""

    robot: pdoik.Robot
    scene: Scene
    T_base_tip: FloatArray  # (4, 4)
    n_taken_in: int  # points that the solver was given
    intake: float  # [s]
    result: pdoik.Result
    verdict: Verdict  # on the whole scan
    confirmed: bool

    @property
    def solved(self) -> bool:
        """Whether the solver claims it and NumPy confirms it on the whole scan."""
        return self.result.success and self.confirmed

    @property
    def wrong(self) -> bool:
        """Whether the solver claims it and NumPy does not."""
        return self.result.success and not self.confirmed


def main(
    targets: Annotated[int, typer.Option(min=1, help="Per arm.")] = 200,
    robot: Annotated[list[str] | None, typer.Option(help="One of the arms; repeatable.")] = None,
    max_objects: Annotated[int, typer.Option(min=1, help="Most objects in a scene.")] = 9,
    leaf: Annotated[
        float | None,
        typer.Option(
            help="Give the solver balls that hold the scan, one for each cell of this edge [m],"
            " in place of all its points."
        ),
    ] = None,
    goal: Annotated[
        Literal["pose", "axis", "position"], typer.Option(help="Of the solver.")
    ] = "pose",
    clearance: Annotated[float, typer.Option(help="Wanted between points and hulls [m].")] = 0.0,
    max_time: Annotated[float, typer.Option(help="Deadline of a solve [s].")] = 0.1,
    ycb: Annotated[
        Path | None,
        typer.Option(
            help="Folder with cloud_vertices/*.pcd of the YCB objects."
            " $PDOIK_SHARED/ycb otherwise, or else primitives."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of targets and scenes.")] = 0,
    out: Annotated[Path, typer.Option(help="Picture of one solution, .png.")] = PICTURE,
) -> None:
    """Solve random targets among random clutter with three arms, check every success again."""
    try:
        if out == PICTURE:
            out.parent.mkdir(parents=True, exist_ok=True)
        if out.suffix.lower() != ".png" or not out.parent.is_dir():
            raise ValueError(f"--out: expected a .png file in a folder that exists, got {out}")
        shared = Path(os.environ.get("PDOIK_SHARED", "/nowhere")) / "ycb"
        ycb = ycb or (shared if shared.is_dir() else None)
        models = ycb_models(ycb) if ycb else primitive_models()
        made = "YCB scans" if ycb else "shapes made from primitives (--ycb DIR takes real scans)"
        options = pdoik.Options(goal=goal, clearance=clearance, max_time=max_time)
        given = "the whole scan" if leaf is None else f"balls that hold the scan, leaf {leaf:g} m,"
        console.print(
            f"objects: {len(models)} {made}\n"
            f"scenes: 1 to {max_objects} objects, scaled 1 to 3 times; {given} given to the solver"
            f"\ntargets: {targets} per arm, {goal} goals, within {options.position_tolerance:g} m"
            f" and {options.rotation_tolerance:g} rad, clearance {clearance:g} m",
            highlight=False,
        )
        outcomes = []
        for index, name in enumerate(robot or ROBOTS):
            rng = np.random.default_rng([seed, index])
            outcomes.append(_run(name, options, models, targets, max_objects, leaf, rng))
    except (pdoik.LoadError, SceneError, ValueError, OSError) as error:
        Console(stderr=True).print(f"[bold red]error:[/] {error}", highlight=False, soft_wrap=True)
        raise typer.Exit(2) from error
    console.print(_table(outcomes))
    _draw(out, [row for rows in outcomes for row in rows if row.solved])
    complaints = [complaint for rows in outcomes for complaint in _complaints(rows)]
    for complaint in complaints:
        console.print(f"[bold red]{complaint}[/]")
    if complaints:
        raise typer.Exit(1)


def _run(
    name: str,
    options: pdoik.Options,
    models: Sequence[ObjectModel],
    n_targets: int,
    max_objects: int,
    leaf: float | None,
    rng: np.random.Generator,
) -> list[Outcome]:
    robot = pdoik.Robot.builtin(name)
    if not len(robot.occupancy):
        raise ValueError(f"{name} has no hulls, so nothing could collide")
    solver = pdoik.Solver(robot, options)
    chain = UrdfChain(shipped(name), robot.joint_names)
    solver.solve(robot.fk(robot.mid_configuration()))  # the first call pays for first touches
    columns = (TextColumn("{task.description:8}"), BarColumn(), MofNCompleteColumn())
    hidden = not console.is_terminal
    with Progress(
        *columns, TimeRemainingColumn(), console=console, transient=True, disable=hidden
    ) as progress:
        return [
            solve_one(solver, chain, models, int(rng.integers(1, max_objects + 1)), leaf, rng)
            for _ in progress.track(range(n_targets), description=name)
        ]


def solve_one(
    solver: pdoik.Solver,
    chain: UrdfChain,
    models: Sequence[ObjectModel],
    n_objects: int,
    leaf: float | None,
    rng: np.random.Generator,
) -> Outcome:
    """A target that a posture off itself reaches, among objects that this posture is clear of."""
    robot = solver.robot
    while True:
        q_rand = rng.uniform(robot.lower, robot.upper)
        T_base_tip = robot.fk(q_rand)
        if solver.judge(T_base_tip, q_rand).success:
            break

    def is_clear(scene: Scene) -> bool:
        return solver.judge(T_base_tip, q_rand, obstacles=scene.points).success

    scene = random_scene(rng, models, n_objects, is_clear)
    scan = scene.points
    began = time.perf_counter()
    cloud = pdoik.Cloud(scan, leaf, radii=leaf is not None)
    intake = time.perf_counter() - began
    result = solver.solve(T_base_tip, obstacles=cloud)
    verdict = recheck(chain, robot, solver.options, T_base_tip, result.q, scan)
    return Outcome(
        robot=robot,
        scene=scene,
        T_base_tip=T_base_tip,
        n_taken_in=len(cloud),
        intake=intake,
        result=result,
        verdict=verdict,
        confirmed=verdict.confirms(solver.options),
    )


def _table(outcomes: list[list[Outcome]]) -> Table:
    """A column for each arm: three of them fit where twelve numbers a row would not."""

    def solved(
        figure: Callable[[Sequence[float]], Any], name: str, form: str, scale: float = 1.0
    ) -> Callable[[list[Outcome]], str]:
        """Cell with a figure of the solved ones."""

        def cell(rows: list[Outcome]) -> str:
            values = [scale * getattr(row.verdict, name) for row in rows if row.solved]
            return f"{figure(values):{form}}" if values else "-"

        return cell

    def all_of(
        figure: Callable[[Any], Any], of: Callable[[Outcome], float], form: str
    ) -> Callable[[list[Outcome]], str]:
        return lambda rows: f"{figure([of(row) for row in rows]):{form}}"

    def time_at(quantile: float) -> Callable[[list[Outcome]], str]:
        return all_of(
            lambda times: np.quantile(times, quantile), lambda row: 1e3 * row.result.time, ".3f"
        )

    cells: dict[str, Callable[[list[Outcome]], str]] = {
        "solved, clear of the whole scan": lambda rows: (
            f"{sum(row.solved for row in rows)} / {len(rows)}"
        ),
        "claimed, but NumPy disagrees": all_of(sum, lambda row: row.wrong, "d"),
        "least clearance to the scan [mm]": solved(min, "clearance", ".3f", 1e3),
        "position error, median [m]": solved(np.median, "position_error", ".1e"),
        "position error, max [m]": solved(max, "position_error", ".1e"),
        "rotation error, median [rad]": solved(np.median, "rotation_error", ".1e"),
        "rotation error, max [rad]": solved(max, "rotation_error", ".1e"),
        "points of a scan, mean": lambda rows: (
            f"{np.mean([len(r.scene.points) for r in rows]):.0f}"
        ),
        "points or balls taken in, mean": lambda rows: (
            f"{np.mean([row.n_taken_in for row in rows]):.0f}"
        ),
        "taking them in, median [ms]": lambda rows: (
            f"{1e3 * np.median([row.intake for row in rows]):.3f}"
        ),
        "time, median [ms]": time_at(0.5),
        "time, p95 [ms]": time_at(0.95),
        "time, p99 [ms]": time_at(0.99),
        "time, max [ms]": time_at(1.0),
    }
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("")
    for rows in outcomes:
        table.add_column(rows[0].robot.name, justify="right")
    for name, cell in cells.items():
        table.add_row(escape(name), *map(cell, outcomes))
    return table


def _draw(out: Path, solved: list[Outcome]) -> None:
    """Draw a crowded scene: of the solved ones, the tightest with most objects."""
    if not solved:
        console.print("nothing was solved, so there is no picture")
        return
    shown = [
        row
        for row in solved
        if row.verdict.clearance > _SHOWN_CLEARANCE and row.T_base_tip[2, 3] > _SHOWN_HEIGHT
    ]
    show = max(shown or solved, key=lambda row: (len(row.scene.objects), -row.verdict.clearance))
    draw_solution(out, pdoik.Solver(show.robot), show.result, show.T_base_tip, show.scene.points)
    names = ", ".join(sorted({placed.model.name for placed in show.scene.objects}))
    console.print(f"{out}: {show.robot.name} among {names}", highlight=False)


def _complaints(rows: list[Outcome]) -> list[str]:
    name, wrong = rows[0].robot.name, sum(row.wrong for row in rows)
    complaints = []
    if sum(row.solved for row in rows) < LEAST_SOLVED * len(rows):
        complaints.append(f"{name}: solved fewer than {LEAST_SOLVED:.0%}")
    if wrong:
        complaints.append(f"{name}: {wrong} successes not confirmed")
    return complaints


if __name__ == "__main__":
    typer.run(main)
