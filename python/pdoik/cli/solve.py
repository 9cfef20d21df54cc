"""pdoik solve: one target, one robot, one scene."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import typer

import pdoik
from pdoik._extras import asks_for
from pdoik.descriptions.text import shipped_name
from pdoik.reports import ending_of

from .messages import NOT_SOLVED, fail, misuse_fails, out, tell, warn
from .obstacles import Obstacles, load_obstacles
from .options import (
    GOAL,
    ROBOT,
    BaseCollision,
    BaseLink,
    Clearance,
    CloudFile,
    ForgiveOverhang,
    Goal,
    GoalAxis,
    HullsFile,
    Leaf,
    Method,
    Radii,
    SceneFile,
    SelfCollision,
    SrdfFile,
)
from .report import Solution, facts, print_report
from .robots import (
    ANY_ROBOT,
    PackageDirs,
    XacroArguments,
    described,
    load_robot,
    numbers,
)
from .tables import json_text
from .target import FORMS, parse_target

FloatArray = npt.NDArray[np.float64]
_DEFAULTS = pdoik.Options()
_SEARCH, _OUTPUT = "Search", "Output"  # panels


def solve(
    target: Annotated[
        str,
        typer.Option(
            help=f"Where the tip is to go, in metres and radians: {FORMS}.",
            metavar="TARGET",
            rich_help_panel=GOAL,
        ),
    ],
    robot: Annotated[
        str | None, typer.Argument(help=f"{ANY_ROBOT}.", metavar="ROBOT", show_default=False)
    ] = None,
    robot_option: Annotated[
        str | None,
        typer.Option("--robot", help="The same as an option.", metavar="ROBOT", hidden=True),
    ] = None,
    occupancy: HullsFile = None,
    srdf: SrdfFile = None,
    base_link: BaseLink = None,
    tip_link: Annotated[
        str | None, typer.Option(help="Last link; the only leaf otherwise.", rich_help_panel=ROBOT)
    ] = None,
    goal: Annotated[
        Goal, typer.Option(help="What of the target counts.", rich_help_panel=GOAL)
    ] = "pose",
    goal_axis: GoalAxis = "z",
    position_tolerance: Annotated[
        float, typer.Option(help="Largest error of a success, metres.", rich_help_panel=GOAL)
    ] = _DEFAULTS.position_tolerance,
    rotation_tolerance: Annotated[
        float, typer.Option(help="Largest error of a success, radians.", rich_help_panel=GOAL)
    ] = _DEFAULTS.rotation_tolerance,
    cloud: CloudFile = None,
    scene: SceneFile = None,
    leaf: Leaf = 0.02,
    radii: Radii = True,
    base_collision: BaseCollision = _DEFAULTS.base_collision,
    forgive_overhang: ForgiveOverhang = _DEFAULTS.forgive_overhang,
    clearance: Clearance = _DEFAULTS.clearance,
    self_collision: SelfCollision = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    q0: Annotated[
        str | None,
        typer.Option(
            help="Start, one number per joint; the middle of the ranges otherwise.",
            rich_help_panel=_SEARCH,
        ),
    ] = None,
    max_time: Annotated[
        float, typer.Option(help="Deadline, seconds.", rich_help_panel=_SEARCH)
    ] = _DEFAULTS.max_time,
    max_restarts: Annotated[
        int, typer.Option(help="Starts after the first.", rich_help_panel=_SEARCH)
    ] = _DEFAULTS.max_restarts,
    seed: Annotated[
        int, typer.Option(help="Of the restarts' sequence.", rich_help_panel=_SEARCH)
    ] = _DEFAULTS.seed,
    method: Annotated[
        Method,
        typer.Option(
            help="'paper' is the paper's algorithm: one start, nothing else.",
            rich_help_panel=_SEARCH,
        ),
    ] = "default",
    json: Annotated[
        bool, typer.Option("--json", help="Print JSON instead of tables.", rich_help_panel=_OUTPUT)
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(help="Draw the outcome into this .png file.", rich_help_panel=_OUTPUT),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            help="Write question and answer into this .json or .json.gz file, for pdoik report.",
            rich_help_panel=_OUTPUT,
        ),
    ] = None,
) -> None:
    """Find joint positions that put the tip on a target, inside limits, clear of obstacles.

    Exit status: 0 solved, 1 not solved, 2 misuse.

    [bold]Example[/]: pdoik solve panda --target "0.4 0.1 0.5 1 0 0 0" --cloud scan.pcd
    """
    _check_picture(picture)
    _check_report(report)
    if seed < 0:
        fail(f"--seed: expected a whole number, at least 0, got {seed}")
    robot = _one_of(robot, robot_option)
    loaded = load_robot(
        robot, base_link, tip_link, occupancy, srdf, packages=package_dir, arguments=xacro_arg
    )
    with misuse_fails("--target"):
        T_base_tip = parse_target(target, goal)
    start = None
    if q0 is not None:
        with misuse_fails("--q0"):
            start = numbers(q0, loaded)
    if not len(loaded.occupancy):
        for option in ["--cloud"] * (cloud is not None) + ["--scene"] * (scene is not None):
            fail(
                f"{option}: {loaded.name} has no hulls to keep clear; give --occupancy FILE.yaml"
                " (pdoik occupancy ROBOT --out FILE.yaml makes one)"
            )
    obstacles = load_obstacles(cloud, leaf, radii, scene)
    with misuse_fails():
        options = pdoik.Options(
            goal=goal,
            goal_axis=goal_axis,
            position_tolerance=position_tolerance,
            rotation_tolerance=rotation_tolerance,
            clearance=clearance,
            base_collision=base_collision,
            forgive_overhang=forgive_overhang,
            self_collision=self_collision,
            max_time=max_time,
            max_restarts=max_restarts,
            seed=seed,
            method=method,
        )
        solution = _solve(loaded, options, T_base_tip, start, obstacles)

    if json:
        out.print(json_text(facts(solution)), highlight=False, markup=False)
    else:
        print_report(solution)
    if picture is not None:
        _draw(picture, solution)
    if report is not None:
        with misuse_fails():
            urdf = None if shipped_name(robot) else described(robot, package_dir, xacro_arg)
        _write(report, solution, start, urdf)
    if not solution.result.success:
        raise typer.Exit(NOT_SOLVED)


def _solve(
    robot: pdoik.Robot,
    options: pdoik.Options,
    T_base_tip: FloatArray,
    q0: FloatArray | None,
    obstacles: Obstacles | None,
) -> Solution:
    solver = pdoik.Solver(robot, options)
    kept = None if obstacles is None else obstacles.kept()
    result = solver.solve(T_base_tip, q0=q0, obstacles=kept)
    surface_clearance = math.inf
    if obstacles is not None:
        surface_clearance = solver.judge(
            T_base_tip, result.q, obstacles=obstacles.whole()
        ).clearance
    return Solution(
        robot=robot,
        options=options,
        T_base_tip=T_base_tip,
        result=result,
        obstacles=obstacles,
        surface_clearance=surface_clearance,
    )


def _check_picture(picture: Path | None) -> None:
    if picture is None:
        return
    if picture.suffix.lower() != ".png":
        fail(f"--picture: expected a name that ends in .png, got {picture.name!r}")
    if not picture.parent.is_dir():
        fail(f"--picture: there is no folder {picture.parent}")


def _check_report(report: Path | None) -> None:
    if report is None:
        return
    with misuse_fails("--report"):
        ending_of(report)
    if not report.parent.is_dir():
        fail(f"--report: there is no folder {report.parent}")


def _write(report: Path, solution: Solution, q0: FloatArray | None, urdf: str | None) -> None:
    with misuse_fails("--report"):
        pdoik.write_report(
            report,
            pdoik.Solver(solution.robot, solution.options),
            solution.T_base_tip,
            q0=q0,
            obstacles=None if solution.obstacles is None else solution.obstacles.kept(),
            result=solution.result,
            urdf=urdf,
        )
    tell(f"{report}: say in its note what is wrong, and send it; pdoik report {report} asks again")


def _draw(picture: Path, solution: Solution) -> None:
    with asks_for("plot"):
        from pdoik.picture import draw_solution  # matplotlib takes longer to import than to solve

    obstacles = solution.obstacles
    if obstacles is not None and obstacles.shapes:
        warn("--picture draws points, no shapes; pdoik view --scene shows them")
    with misuse_fails("--picture"):
        draw_solution(
            picture,
            solution.robot,
            solution.result,
            solution.T_base_tip,
            cloud=None if obstacles is None else obstacles.cloud[:, :3],
            surface=None if obstacles is None or obstacles.leaf == 0 else obstacles.surface,
        )


def _one_of(argument: str | None, option: str | None) -> str:
    """The robot that was given in one way or the other."""
    if argument is not None and option is not None:
        fail(f"ROBOT {argument} and --robot {option}: expected one of them")
    robot = argument or option
    if robot is None:
        fail('no robot given: pdoik solve ROBOT --target "x y z qx qy qz qw"')
    return robot
