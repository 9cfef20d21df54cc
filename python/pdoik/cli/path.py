"""pdoik path: a whole path of a tool, one robot, one scene."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

import pdoik
from pdoik._extras import asks_for
from pdoik.errors import MissingExtraError, PdoikError

from .interrupts import STOPPED, leave
from .messages import (
    NOT_SOLVED,
    fail,
    misuse_fails,
    out,
    tell,
    warn,
    warn_of_degrees,
    warnings_given,
)
from .obstacles import check_hulls, load_obstacles, solver_of
from .options import (
    GOAL,
    OUTPUT,
    SEARCH,
    BaseCollision,
    BaseLink,
    Clearance,
    CloudFile,
    HullsFile,
    Leaf,
    Locks,
    Radii,
    SceneFile,
    SceneFrame,
    SceneWithout,
    SelfCollision,
    SrdfFile,
    Tool,
)
from .path_file import read_path_file
from .path_files import check_out, timed, write_rows, write_trajectory
from .path_options import (
    Closed,
    Costs,
    Free,
    PathArgument,
    PositionTolerance,
    RobotOption,
    RotationTolerance,
    Spacing,
    TipLink,
    costs_of,
    per_joint,
    robot_of_path,
    tool_of_path,
)
from .path_report import PathAnswer, path_facts, places_of, print_path
from .path_search import search
from .question import joints_of, locks_of
from .robots import PackageDirs, XacroArguments
from .solve_files import check_picture
from .tables import json_text

IN_PIECES = 3
_DEFAULTS = pdoik.Options()
_TIMING = "Timing"  # panel


def path(
    file: PathArgument,
    robot: RobotOption,
    occupancy: HullsFile = None,
    srdf: SrdfFile = None,
    base_link: BaseLink = None,
    tip_link: TipLink = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    free: Free = None,
    spacing: Spacing = None,
    closed: Closed = False,
    start: Annotated[
        str | None,
        typer.Option(help="Joints at the first station; any otherwise.", rich_help_panel=GOAL),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(help="Joints at the last station; any otherwise.", rich_help_panel=GOAL),
    ] = None,
    tool: Tool = None,
    lock: Locks = None,
    position_tolerance: PositionTolerance = _DEFAULTS.position_tolerance,
    rotation_tolerance: RotationTolerance = _DEFAULTS.rotation_tolerance,
    cloud: CloudFile = None,
    scene: SceneFile = None,
    frame: SceneFrame = None,
    without: SceneWithout = None,
    leaf: Leaf = 0.02,
    radii: Radii = True,
    base_collision: BaseCollision = _DEFAULTS.base_collision,
    clearance: Clearance = _DEFAULTS.clearance,
    self_collision: SelfCollision = None,
    cost: Costs = None,
    max_time: Annotated[
        float, typer.Option(help="Deadline of the search, seconds.", rich_help_panel=SEARCH)
    ] = 10.0,
    reconfigure: Annotated[
        bool,
        typer.Option(
            help="Let what cannot be one motion be pieces with moves between them.",
            rich_help_panel=SEARCH,
        ),
    ] = True,
    seed: Annotated[
        int, typer.Option(help="Of the starts' sequence.", rich_help_panel=SEARCH)
    ] = _DEFAULTS.seed,
    speed: Annotated[
        float | None,
        typer.Option(
            help="Of the tool, metres a second; slower where joints cannot. As fast as can be"
            " otherwise.",
            rich_help_panel=_TIMING,
        ),
    ] = None,
    acceleration: Annotated[
        str | None,
        typer.Option(
            help="Largest of joints, rad/s^2 or m/s^2: one number, or one per joint.",
            rich_help_panel=_TIMING,
        ),
    ] = None,
    jerk: Annotated[
        str | None,
        typer.Option(help="The same of jerks; no limit otherwise.", rich_help_panel=_TIMING),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(help="Samples a second; uneven times otherwise.", rich_help_panel=_TIMING),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print JSON instead of lines.", rich_help_panel=OUTPUT)
    ] = False,
    out_file: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="Write joint positions into this .csv file, by time with --acceleration; or into"
            " a .yaml file as a ROS trajectory.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Draw joints, limits and clearance along the path into this .png file.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
) -> None:
    """Follow a whole path with one motion, clear of obstacles; or say where it breaks and why.

    Exit status: 0 whole, 1 no motion found, 2 misuse, 3 pieces only, with or without moves
    between them; 130 after Ctrl-C, which prints and writes what is known by then.

    [bold]Example[/]: pdoik path seam.csv --robot ur10 --free z --speed 0.01 --acceleration 5 --out motion.csv
    """  # noqa: E501
    is_timed = acceleration is not None
    check_picture(picture)
    check_out(out_file, is_timed)
    for option, value in (("--speed", speed), ("--jerk", jerk), ("--rate", rate)):
        if value is not None and not is_timed:
            fail(
                f"{option}: expected --acceleration with it, which robots' descriptions do not have"
            )
    for option, number in (("--speed", speed), ("--rate", rate), ("--max-time", max_time)):
        if number is not None and not (math.isfinite(number) and number > 0):
            fail(f"{option}: expected a positive number, got {number:g}")
    if seed < 0:
        fail(f"--seed: expected a whole number, at least 0, got {seed}")
    if is_timed:
        _needs_scipy()
    with misuse_fails():
        asked = read_path_file(file, free)
        stations = asked.stations(free, spacing)
    loaded = robot_of_path(
        asked, file, robot, base_link, tip_link, occupancy, srdf, package_dir, xacro_arg
    )
    how: dict[str, Any] = {}
    if is_timed:
        how["max_acceleration"] = per_joint("--acceleration", acceleration, loaded)
        how["rate"] = rate
        if jerk is not None:
            how["max_jerk"] = per_joint("--jerk", jerk, loaded)
    T_tip_tool = tool_of_path(tool, loaded)
    warn_of_degrees("--rotation-tolerance", [rotation_tolerance])
    check_hulls(loaded, cloud, scene)
    more: dict[str, Any] = {
        "start": joints_of("--start", start, loaded),
        "end": joints_of("--end", end, loaded),
        "closed": closed,
        "lock": locks_of(lock, loaded) or None,
        "costs": costs_of(cost),
        "reconfigure": reconfigure,
    }
    obstacles = load_obstacles(
        cloud, leaf, radii, scene, loaded, frame=frame, without=without or ()
    )
    kept = None if obstacles is None else obstacles.kept()
    with misuse_fails(), warnings_given():
        options = pdoik.Options(
            T_tip_tool=T_tip_tool,
            position_tolerance=position_tolerance,
            rotation_tolerance=rotation_tolerance,
            clearance=clearance,
            base_collision=base_collision,
            self_collision=self_collision,
            seed=seed,
        )
        solver = solver_of(loaded, options, obstacles)
        searched = search(
            lambda seconds: solver.solve_path(stations, kept, max_time=seconds, **more),
            f"a path of {len(stations)} stations",
            max_time,
        )
    if searched.result is None:
        tell(f"stopped after {searched.seconds:.1f} s: nothing is known yet")
        leave(STOPPED)
    answer = PathAnswer(
        robot=loaded,
        solver=solver,
        stations=stations,
        places=places_of(stations),
        result=searched.result,
        seconds=searched.seconds,
        obstacles=obstacles,
        closed=closed,
    )
    if is_timed:
        tip = None if len(loaded.tip_links) > 1 else loaded.tip_links[0]
        pace = {} if speed is None else {"tool_speed": speed, "tip": tip, "T_tip_tool": T_tip_tool}
        answer = _in_time(answer, how, pace)
    if json:
        out.print(json_text(path_facts(answer)), highlight=False, markup=False)
    else:
        print_path(answer)
    if out_file is not None:
        _write(out_file, answer, is_timed)
    if picture is not None:
        with asks_for("plot"):
            from pdoik.picture import draw_path  # matplotlib takes longer than most paths
        with misuse_fails("--picture"):
            draw_path(picture, solver, answer.result, kept, title=f"{loaded.name}: {file.name}")
    if searched.is_stopped:
        tell(f"stopped after {searched.seconds:.1f} s: this is what was known")
        leave(STOPPED)
    if not answer.result.success:
        raise typer.Exit(IN_PIECES if answer.result.status == "pieces" else NOT_SOLVED)
    if is_timed and answer.trajectory is None:
        raise typer.Exit(NOT_SOLVED)


def _needs_scipy() -> None:
    with asks_for("timing"):
        import scipy  # noqa: F401


def _in_time(answer: PathAnswer, how: dict[str, Any], pace: dict[str, Any]) -> PathAnswer:
    """Answer with its trajectory, where there is a way to the end of what was found."""
    from dataclasses import replace

    result = answer.result
    if not len(result.q):
        return answer
    if any(not len(move) for move in result.moves):
        warn("there is no move between two pieces, and so no times: rows are written without them")
        return answer
    try:
        trajectory, recheck = timed(answer.robot, answer.solver, result, answer.scene, how, pace)
    except MissingExtraError:
        raise
    except (PdoikError, ValueError) as error:
        warn(f"not timed: {error}")
        return answer
    if not recheck.success:
        warn(f"the timed motion touches at {recheck.time:.2f} s: {recheck.worst.worst_constraint}")
    return replace(answer, trajectory=trajectory, recheck=recheck)


def _write(file: Path, answer: PathAnswer, is_timed: bool) -> None:
    with misuse_fails("--out"):
        if answer.trajectory is not None:
            write_trajectory(file, answer.trajectory)
        elif len(answer.result.q) and (not is_timed or file.suffix.lower() == ".csv"):
            write_rows(file, answer.robot, answer.result)
        else:
            warn(f"--out: nothing to write, {file} is as it was")
            return
    remarks = {"whole": "", "pieces": ": pieces, with the moves between them that were found"}
    only = remarks.get(answer.result.status, ": of what was found, not the whole path")
    tell(f"wrote {file}{only}")
