"""pdoik bench: how long solves take on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt
import typer
from rich import box
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

import pdoik
from pdoik._hulls import gaps, placed_hulls

from .messages import err, misuse_fails, out, warn
from .robots import ANY_ROBOT, BUILTIN, load_robot
from .tables import length_text, time_text

FloatArray = npt.NDArray[np.float64]

_NEAREST, _FARTHEST = 0.02, 0.3  # gaps from a target's posture to its obstacle points [m]
_N_WARM_UP = 20
_POSTURES = 1000  # drawn until one does not touch itself


class Problem(NamedTuple):
    """A target that can be reached, because a random posture defines it."""

    T_base_tip: FloatArray  # (4, 4)
    points: FloatArray  # (N, 3), clear of that posture [m]


def bench(
    robot: Annotated[
        list[str] | None,
        typer.Option(help=f"{ANY_ROBOT}; repeatable. All built-in ones otherwise."),
    ] = None,
    targets: Annotated[int, typer.Option(min=1, help="How many per row.")] = 1000,
    obstacles: Annotated[
        int, typer.Option(min=0, help="Obstacle points per target; 0 leaves out that row.")
    ] = 100,
    occupancy: Annotated[Path | None, typer.Option(help="Hulls of a URDF robot, YAML.")] = None,
    tip_link: Annotated[str | None, typer.Option(help="Last link of a URDF robot.")] = None,
    max_time: Annotated[float, typer.Option(help="Deadline of a solve, seconds.")] = 0.01,
    seed: Annotated[int, typer.Option(min=0, help="Of targets and points.")] = 0,
) -> None:
    """Time solves of random pose targets, one after the other on one core.

    A target is the tip's pose in a random posture that does not touch itself, so each has a
    solution. Its obstacle points lie 2 to 30 cm from that posture's hulls. Times are the solver's
    own.

    [bold]Example[/]: pdoik bench --robot panda --targets 500 --obstacles 200
    """
    with misuse_fails():
        options = pdoik.Options(max_time=max_time)
    robots = [load_robot(name, None, tip_link, occupancy) for name in robot or BUILTIN]
    table = Table(
        title=f"{targets} pose targets each, seed {seed}", title_justify="left", box=box.SIMPLE_HEAD
    )
    table.add_column("robot", no_wrap=True)
    for name in ("points", "solved", "median", "p95", "p99", "max"):
        table.add_column(name, justify="right", no_wrap=True)
    for one in robots:
        counts = [0] if obstacles == 0 or not len(one.occupancy) else [0, obstacles]
        if obstacles and not len(one.occupancy):
            warn(f"{one.name} has no hulls, so no obstacles: give --occupancy")
        for n_points in counts:
            with misuse_fails(one.name):
                results = _run(one, options, targets, n_points, np.random.default_rng(seed))
            table.add_row(escape(one.name), str(n_points), *_cells(results))
    out.print(table)
    tolerances = f"{length_text(options.position_tolerance)}, {options.rotation_tolerance:.0e} rad"
    out.print(
        f"solved: within {tolerances}, inside limits, clear of the points\n"
        "times: of all solves, solved or not",
        highlight=False,
        style="dim",
    )


def random_problem(solver: pdoik.Solver, n_points: int, rng: np.random.Generator) -> Problem:
    """A target within reach, and points that leave room for one solution at least.

    Raises:
        ValueError: The robot has no hulls, but points are wanted; or it always touches itself.
    """
    robot = solver.robot
    q = _random_posture(solver, rng)
    points = np.empty((0, 3))
    if n_points:
        hulls = placed_hulls(robot, q)
        if not hulls:
            raise ValueError(f"{robot.name} has no hulls to keep points clear of")
        ends = np.concatenate([hull.ends for hull in hulls])
        box = ends.min(axis=0) - _FARTHEST, ends.max(axis=0) + _FARTHEST
        while len(points) < n_points:
            drawn = rng.uniform(*box, size=(4 * n_points, 3))
            gap = gaps(hulls, drawn)
            points = np.concatenate([points, drawn[(gap > _NEAREST) & (gap < _FARTHEST)]])
    return Problem(robot.fk(q), points[:n_points])


def _random_posture(solver: pdoik.Solver, rng: np.random.Generator) -> FloatArray:
    robot = solver.robot
    lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    for _ in range(_POSTURES):
        q = rng.uniform(lower, upper)
        if solver.judge(robot.fk(q), q).success:
            return q
    raise ValueError(f"{robot.name} touches itself by its hulls in {_POSTURES} random postures")


def _run(
    robot: pdoik.Robot,
    options: pdoik.Options,
    n_targets: int,
    n_points: int,
    rng: np.random.Generator,
) -> list[pdoik.Result]:
    solver = pdoik.Solver(robot, options)
    warm_up = random_problem(solver, n_points, rng)
    for _ in range(_N_WARM_UP):
        solver.solve(warm_up.T_base_tip, obstacles=warm_up.points)
    results = []
    with Progress(console=err, transient=True, disable=not err.is_terminal) as progress:
        label = f"{robot.name}, {n_points} points"
        for _ in progress.track(range(n_targets), description=label):
            problem = random_problem(solver, n_points, rng)
            results.append(solver.solve(problem.T_base_tip, obstacles=problem.points))
    return results


def _cells(results: list[pdoik.Result]) -> list[str]:
    n_solved = sum(result.success for result in results)
    times = np.array([result.time for result in results])
    quantiles = (float(np.quantile(times, share)) for share in (0.5, 0.95, 0.99, 1.0))
    return [f"{n_solved} / {len(results)}", *(time_text(quantile) for quantile in quantiles)]
