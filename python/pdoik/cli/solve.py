"""pdoik solve: one target, one robot, one scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import typer

import pdoik
from pdoik.descriptions import shipped_name

from .all_report import print_all
from .facts import all_facts, facts
from .goal_file import read_goal_file
from .messages import NOT_SOLVED, fail, misuse_fails, out, warn_of_degrees, warnings_given
from .obstacles import Obstacles, check_hulls, load_obstacles, solver_of
from .options import (
    GOAL,
    OUTPUT,
    ROBOT,
    SEARCH,
    All,
    AnyFile,
    BaseCollision,
    BaseLink,
    Clearance,
    CloudFile,
    Goal,
    GoalAxis,
    GoalsFile,
    HullsFile,
    Leaf,
    Limit,
    Locks,
    Method,
    Priority,
    Radii,
    SceneFile,
    SceneFrame,
    SceneWithout,
    SelfCollision,
    SrdfFile,
    Tool,
)
from .question import Question, check_goals, question_of, robot_for, tool_of
from .report import print_report
from .robots import (
    ANY_ROBOT,
    PackageDirs,
    XacroArguments,
    described,
    load_robot,
)
from .solution import AllSolutions, Solution
from .solve_files import check_picture, check_report, draw, write_report
from .tables import json_text
from .target import FORMS

FloatArray = npt.NDArray[np.float64]
_DEFAULTS = pdoik.Options()


def solve(
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
    target: Annotated[
        str | None,
        typer.Option(
            help=f"Where the tip is to go, in metres and radians: {FORMS}.",
            metavar="TARGET",
            rich_help_panel=GOAL,
        ),
    ] = None,
    goals: GoalsFile = None,
    any_: AnyFile = None,
    tool: Tool = None,
    priority: Priority = "both",
    lock: Locks = None,
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
    frame: SceneFrame = None,
    without: SceneWithout = None,
    leaf: Leaf = 0.02,
    radii: Radii = True,
    base_collision: BaseCollision = _DEFAULTS.base_collision,
    clearance: Clearance = _DEFAULTS.clearance,
    self_collision: SelfCollision = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    q0: Annotated[
        str | None,
        typer.Option(
            help="Start, one number per joint; the middle of the ranges otherwise.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    max_time: Annotated[
        float, typer.Option(help="Deadline, seconds.", rich_help_panel=SEARCH)
    ] = _DEFAULTS.max_time,
    max_restarts: Annotated[
        int, typer.Option(help="Starts after the first.", rich_help_panel=SEARCH)
    ] = _DEFAULTS.max_restarts,
    seed: Annotated[
        int, typer.Option(help="Of the restarts' sequence.", rich_help_panel=SEARCH)
    ] = _DEFAULTS.seed,
    all_: All = False,
    limit: Limit = None,
    method: Annotated[
        Method,
        typer.Option(
            help="'paper' is the paper's algorithm: one start, nothing else.",
            rich_help_panel=SEARCH,
        ),
    ] = "default",
    json: Annotated[
        bool, typer.Option("--json", help="Print JSON instead of tables.", rich_help_panel=OUTPUT)
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(help="Draw the outcome into this .png file.", rich_help_panel=OUTPUT),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            help="Write question and answer into this .json or .json.gz file, for pdoik report.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
) -> None:
    """Find joint positions that put the tip on a target, inside limits, clear of obstacles.

    A tip may have a tool, and joints be locked; a file may have several goals of any kind, or poses
    any one of which will do; and all solutions may be asked for.

    Exit status: 0 solved, 1 not solved, 2 misuse.

    [bold]Example[/]: pdoik solve panda --target "0.4 0.1 0.5 1 0 0 0" --cloud scan.pcd
    """
    check_picture(picture)
    check_report(report)
    if seed < 0:
        fail(f"--seed: expected a whole number, at least 0, got {seed}")
    if limit is not None and not all_:
        fail("--limit: expected with --all, of which it is")
    robot = _one_of(robot, robot_option)
    check_goals(target, goals, any_, all_)
    with misuse_fails():
        listed = None if goals is None else read_goal_file(goals)

    def read(tips: list[str] | None) -> pdoik.Robot:
        return load_robot(
            robot, base_link, tips, occupancy, srdf, packages=package_dir, arguments=xacro_arg
        )

    loaded = robot_for(read, listed, goals, tip_link)
    question = question_of(
        target, listed, goals, any_, loaded, goal=goal, is_all=all_, limit=limit, q0=q0, lock=lock
    )
    T_tip_tool = tool_of(tool, loaded, "--goals")
    warn_of_degrees("--rotation-tolerance", [rotation_tolerance])
    check_hulls(loaded, cloud, scene)
    obstacles = load_obstacles(
        cloud, leaf, radii, scene, loaded, frame=frame, without=without or ()
    )
    with misuse_fails(), warnings_given():
        options = pdoik.Options(
            goal=goal,
            goal_axis=goal_axis,
            T_tip_tool=T_tip_tool,
            priority=priority,
            position_tolerance=position_tolerance,
            rotation_tolerance=rotation_tolerance,
            clearance=clearance,
            base_collision=base_collision,
            self_collision=self_collision,
            max_time=max_time,
            max_restarts=max_restarts,
            seed=seed,
            method=method,
        )
        solution = _solve(loaded, options, question, obstacles)

    if json:
        content = facts(solution) if isinstance(solution, Solution) else all_facts(solution)
        out.print(json_text(content), highlight=False, markup=False)
    elif isinstance(solution, Solution):
        print_report(solution)
    else:
        print_all(solution)
    if picture is not None:
        draw(picture, solution)
    if report is not None:
        with misuse_fails():
            urdf = None if shipped_name(robot) else described(robot, package_dir, xacro_arg)
        write_report(report, solution, urdf)
    if not solution.is_found:
        raise typer.Exit(NOT_SOLVED)


def _solve(
    robot: pdoik.Robot, options: pdoik.Options, question: Question, obstacles: Obstacles | None
) -> Solution | AllSolutions:
    solver = solver_of(robot, options, obstacles)
    kept = None if obstacles is None else obstacles.kept()
    answer = question.ask(solver, kept)
    about: dict[str, Any] = {
        "robot": robot,
        "options": options,
        "question": question,
        "obstacles": obstacles,
    }
    if question.call == "solve_all":
        return AllSolutions(answer=answer, **about)
    if obstacles is not None:
        judged = solver.judge(question.met(answer), answer.q, obstacles=obstacles.whole())
        about |= {"surface_clearance": judged.clearance, "surface_room": judged.room}
    return Solution(result=answer, **about)


def _one_of(argument: str | None, option: str | None) -> str:
    """The robot that was given in one way or the other."""
    if argument is not None and option is not None:
        fail(f"ROBOT {argument} and --robot {option}: expected one of them")
    robot = argument or option
    if robot is None:
        fail('no robot given: pdoik solve ROBOT --target "x y z qx qy qz qw"')
    return robot
