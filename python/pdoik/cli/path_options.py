"""Options that path and place share, and what they are taken to mean."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import pdoik

from .messages import fail
from .options import GOAL, ROBOT, SEARCH, Axis
from .path_file import PathFile
from .question import robot_for, tool_of
from .robots import ANY_ROBOT, load_robot

_COSTS = ("motion", "limits", "obstacles", "singularities", "room")

PathArgument = Annotated[
    Path,
    typer.Argument(
        help="Of stations, or of corners with --spacing: .csv with columns x y z and qx qy qz qw,"
        " roll pitch yaw, or ax ay az (the tool's axis); or .yaml with a list of goals.",
        metavar="PATH",
        show_default=False,
    ),
]
RobotOption = Annotated[
    str, typer.Option("--robot", help=f"{ANY_ROBOT}.", metavar="ROBOT", rich_help_panel=ROBOT)
]
TipLink = Annotated[
    str | None,
    typer.Option(
        "--tip-link", "--tip", help="Last link; the only leaf otherwise.", rich_help_panel=ROBOT
    ),
]
Free = Annotated[
    Axis | None,
    typer.Option(
        help="Axis of the tool that it may turn about; of ax ay az the axis that these are of.",
        rich_help_panel=GOAL,
    ),
]
Spacing = Annotated[
    float | None,
    typer.Option(
        help="Rows are corners, and stations at most this far apart on straight lines between"
        " them, metres.",
        rich_help_panel=GOAL,
    ),
]
Closed = Annotated[
    bool,
    typer.Option(
        "--closed", help="Go on to the first station, and end where it began.", rich_help_panel=GOAL
    ),
]
PositionTolerance = Annotated[
    float, typer.Option(help="Largest error at stations, metres.", rich_help_panel=GOAL)
]
RotationTolerance = Annotated[
    float, typer.Option(help="Largest error at stations, radians.", rich_help_panel=GOAL)
]
Costs = Annotated[
    list[str] | None,
    typer.Option(
        "--cost",
        help=f"What is kept small besides the motion: {', '.join(_COSTS)}; repeatable.",
        metavar="NAME=WEIGHT",
        rich_help_panel=SEARCH,
    ),
]


def robot_of_path(
    asked: PathFile,
    file: Path,
    robot: str,
    base_link: str | None,
    tip_link: str | None,
    occupancy: Path | None,
    srdf: Path | None,
    package_dir: list[str] | None,
    xacro_arg: list[str] | None,
) -> pdoik.Robot:
    """Robot with the tips that the path is about; leaves with status 2 where there is none."""

    def read(tips: list[str] | None) -> pdoik.Robot:
        return load_robot(
            robot, base_link, tips, occupancy, srdf, packages=package_dir, arguments=xacro_arg
        )

    stations = asked.goals
    goals = None if stations is None else [goal for station in stations for goal in station]
    loaded = robot_for(read, goals, file, tip_link)
    if goals is None and len(loaded.tip_links) > 1:
        fail(f"--tip-link: expected one of {', '.join(loaded.tip_links)}, which are to follow it")
    return loaded


def tool_of_path(tool: str | None, robot: pdoik.Robot) -> Any:
    """Tool on the tip, (4, 4)."""
    return tool_of(tool, robot, "a path of goals")


def per_joint(option: str, text: str | None, robot: pdoik.Robot) -> Any:
    """A positive number for all joints, or one each, (n,)."""
    words = (text or "").replace(",", " ").split()
    try:
        values = np.array([float(word) for word in words])
    except ValueError:
        values = np.array([])
    if len(values) not in (1, robot.dof) or not (values > 0).all():
        fail(f"{option}: expected a positive number, or {robot.dof}, one per joint; got {text!r}")
    return float(values[0]) if len(values) == 1 else values


def costs_of(given: list[str] | None) -> dict[str, float] | None:
    """Costs that --cost gives, by name; None without any."""
    found: dict[str, float] = {}
    for text in given or ():
        name, _, word = text.partition("=")
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if name not in _COSTS or not (math.isfinite(value) and value >= 0):
            fail(f"--cost: expected NAME=WEIGHT with a name of {', '.join(_COSTS)}, got {text!r}")
        found[name] = value
    return found or None
