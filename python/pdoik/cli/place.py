"""pdoik place: where a base should stand so that a whole path works."""

from __future__ import annotations

import math
from os import sched_getaffinity
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

import typer
from rich import box
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

import pdoik
from pdoik.base_places import places_of

from .interrupts import STOPPED, noted
from .messages import NOT_SOLVED, err, fail, misuse_fails, out, tell, warn, warnings_given
from .obstacles import check_hulls, load_obstacles, refuse_attached
from .options import (
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
    robot_of_path,
    tool_of_path,
)
from .question import locks_of
from .robots import PackageDirs, XacroArguments
from .solve_files import check_picture
from .tables import length_text, time_text

_DEFAULTS = pdoik.Options()
_PLACES = "Places"  # panel
_STATION = 0.1  # for a station's search: all processors are busy [s]
_SHOWN = 5  # rows of the table


def _range_option(what: str) -> Any:
    return typer.Option(
        help=f"{what} that is tried: one number, or FROM:TO:STEP.",
        metavar="RANGE",
        rich_help_panel=_PLACES,
    )


def place(
    file: PathArgument,
    robot: RobotOption,
    x: Annotated[str, _range_option("x, metres,")] = "0",
    y: Annotated[str, _range_option("y, metres,")] = "0",
    z: Annotated[str, _range_option("z, metres,")] = "0",
    yaw: Annotated[str, _range_option("Turn about z, radians,")] = "0",
    move: Annotated[
        Literal["base", "part"],
        typer.Option(
            help="What is placed: the base among path and obstacles, or the path (the part's)"
            " before the base.",
            rich_help_panel=_PLACES,
        ),
    ] = "base",
    occupancy: HullsFile = None,
    srdf: SrdfFile = None,
    base_link: BaseLink = None,
    tip_link: TipLink = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    free: Free = None,
    spacing: Spacing = None,
    closed: Closed = False,
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
        float,
        typer.Option(help="For the path, from each place, seconds.", rich_help_panel=SEARCH),
    ] = 1.0,
    every: Annotated[
        int,
        typer.Option(
            help="Every so many stations one is looked at first; of these all have to be reached.",
            rich_help_panel=SEARCH,
        ),
    ] = 10,
    threads: Annotated[
        int, typer.Option(help="0 for one per processor.", rich_help_panel=SEARCH)
    ] = 0,
    out_file: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="Write all places into this .csv or .npz file. An .npz is kept up to date all"
            " along, and the same command goes on from it.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(help="Draw a map into this .png file.", rich_help_panel=OUTPUT),
    ] = None,
) -> None:
    """Try places for a robot's base, and say from which one a whole path has the most room.

    Path and obstacles are in the world's frame, and so are the places; with --move part the path is
    in the part's, obstacles and places in the base's.

    Exit status: 0 whole from some place, 1 from none, 2 misuse; 130 after Ctrl-C, which prints and
    writes what is known by then.

    [bold]Example[/]: pdoik place seam.csv --robot ur10 --x -0.5:0.5:0.1 --out places.csv
    """
    check_picture(picture)
    if out_file is not None:
        if out_file.suffix.lower() not in (".csv", ".npz"):
            fail(f"--out: expected a name that ends in .csv or .npz, got {out_file.name!r}")
        if not out_file.parent.is_dir():
            fail(f"--out: there is no folder {out_file.parent}")
    for option, number in (("--max-time", max_time), ("--every", every)):
        if not (math.isfinite(number) and number > 0):
            fail(f"{option}: expected a positive number, got {number:g}")
    if threads < 0:
        fail(f"--threads: expected a whole number, at least 0, got {threads}")
    given = {"x": x, "y": y, "z": z, "yaw": yaw}
    region = {name: _range(f"--{name}", text) for name, text in given.items()}
    with misuse_fails():
        asked = read_path_file(file, free)
        stations = asked.stations(free, spacing)
    loaded = robot_of_path(
        asked, file, robot, base_link, tip_link, occupancy, srdf, package_dir, xacro_arg
    )
    check_hulls(loaded, cloud, scene)
    obstacles = load_obstacles(
        cloud, leaf, radii, scene, loaded, frame=frame, without=without or ()
    )
    refuse_attached(obstacles)
    is_kept = out_file is not None and out_file.suffix.lower() == ".npz"
    is_stopped = False
    with (
        TemporaryDirectory(prefix="pdoik-places-") as folder,
        misuse_fails(),
        warnings_given(),
        _progress() as bar,
        noted() as stop,
    ):
        keep = out_file if is_kept and out_file is not None else Path(folder) / "places.npz"
        options = pdoik.Options(
            T_tip_tool=tool_of_path(tool, loaded),
            position_tolerance=position_tolerance,
            rotation_tolerance=rotation_tolerance,
            clearance=clearance,
            base_collision=base_collision,
            self_collision=self_collision,
            max_time=_STATION,
        )
        task = bar.add_task("places", total=len(places_of(region)))

        def progress(done: int) -> None:
            bar.update(task, completed=done)
            if not stop.empty():
                raise _StoppedError

        try:
            found = pdoik.place_base(
                loaded,
                [stations],
                None if obstacles is None else obstacles.kept(),
                region=region,
                move=move,
                closed=closed,
                lock=locks_of(lock, loaded) or None,
                options=options,
                costs=costs_of(cost),
                max_time=max_time,
                every=every,
                threads=threads,
                progress=progress,
                chunk=2 * (threads or len(sched_getaffinity(0))),
                keep=keep,
            )
        except _StoppedError:
            found = pdoik.BasePlaces.load(keep)
            is_stopped = True
    _print(found)
    if out_file is not None:
        with misuse_fails("--out"):
            if not is_kept:
                found.save(out_file)
        tell(f"wrote {out_file}")
    if picture is not None:
        with misuse_fails("--picture"):
            found.map(picture, title=f"{loaded.name}, {file.name}")
    if is_stopped:
        hint = "the same command goes on" if is_kept else "with an .npz as --out it could go on"
        tell(f"stopped after {int(found.done.sum())} of {len(found)} places; {hint}")
        raise typer.Exit(STOPPED)
    if not found.whole.any():
        raise typer.Exit(NOT_SOLVED)


class _StoppedError(Exception):
    """The search was stopped by Ctrl-C."""


def _progress() -> Progress:
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    return Progress(*columns, TimeElapsedColumn(), console=err, transient=True)


def _range(option: str, text: str) -> Any:
    """A number, or from, to and step."""
    try:
        numbers = [float(word) for word in text.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3) or not all(math.isfinite(number) for number in numbers):
        fail(f"{option}: expected a number or FROM:TO:STEP, got {text!r}")
    if len(numbers) == 3 and not (numbers[2] > 0 and numbers[1] >= numbers[0]):
        fail(f"{option}: expected FROM:TO:STEP, with TO not below FROM, got {text!r}")
    return numbers[0] if len(numbers) == 1 else tuple(numbers)


def _print(found: pdoik.BasePlaces) -> None:
    count = int(found.whole.sum())
    color = "green" if count else "red"
    out.print(
        f"[bold {color}]whole from {count} of {len(found)} places[/],"
        f" in {time_text(found.seconds)}",
        highlight=False,
    )
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("x", "y", "z", "yaw", "room", "clear", "limits", "singular", "length"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("outcome", no_wrap=True)
    for k in found.order[: min(_SHOWN, int(found.done.sum()))].tolist():
        best = found[k]
        place = [f"{value:.3f}" for value in (best.x, best.y, best.z, best.yaw)]
        figures = [length_text(best.clearance), f"{best.limits:.3f}", length_text(best.singularity)]
        if not best.success:
            figures = ["", "", ""]
        length = f"{best.length:.3f}" if best.success else ""
        outcome = "whole"
        if best.status == "unreached":
            outcome = f"{best.reached:.0%} reached"
        elif not best.success:
            outcome = f"{best.followed:.0%} followed"
        table.add_row(*place, f"{best.score:.3f}", *figures, length, outcome)
    out.print(table)
    if not count:
        warn("from no place is the path whole: these come nearest")
