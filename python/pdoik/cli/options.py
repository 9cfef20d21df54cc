"""Options that solve and view share, each with its panel of the help."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

ROBOT, GOAL, OBSTACLES, SEARCH = "Robot", "Goal", "Obstacles", "Search"  # panels
OUTPUT = "Output"

Goal = Literal["pose", "axis", "position"]
Axis = Literal["x", "y", "z"]
Method = Literal["default", "paper"]

BaseLink = Annotated[
    str | None, typer.Option(help="First link; the root otherwise.", rich_help_panel=ROBOT)
]
HullsFile = Annotated[
    Path | None,
    typer.Option(help="Hulls of the robot, YAML (see pdoik occupancy).", rich_help_panel=ROBOT),
]
SrdfFile = Annotated[
    Path | None,
    typer.Option(
        help="SRDF with the pairs of links that may touch (see pdoik pairs).",
        rich_help_panel=ROBOT,
    ),
]
SelfCollision = Annotated[
    bool | None,
    typer.Option(
        help="Keep hulls off one another; on with capsules and an SRDF otherwise.",
        rich_help_panel=GOAL,
    ),
]
GoalAxis = Annotated[Axis, typer.Option(help="Of the tip, for --goal axis.", rich_help_panel=GOAL)]
CloudFile = Annotated[
    Path | None,
    typer.Option(
        help="Points in the base frame, metres: .pcd, .ply, .npy, .xyz, .txt, .csv.",
        rich_help_panel=OBSTACLES,
    ),
]
SceneFile = Annotated[
    Path | None,
    typer.Option(
        "--scene",
        help="Shapes, and perhaps a cloud: .yaml (pdoik's or MoveIt's), .scene, MuJoCo's .xml,"
        " Gazebo's .sdf and .world, OctoMap's .bt and .ot; without the robot itself.",
        rich_help_panel=OBSTACLES,
    ),
]
SceneFrame = Annotated[
    str | None,
    typer.Option(
        "--frame",
        help="Whose frame in --scene is the robot's base frame: a body or site of MuJoCo's worlds,"
        " a model, link or frame of Gazebo's, MoveIt's word for it; the robot's own otherwise.",
        metavar="NAME",
        rich_help_panel=OBSTACLES,
    ),
]
SceneWithout = Annotated[
    list[str] | None,
    typer.Option(
        "--without",
        help="Body, model, object or shape of --scene that is left out; repeatable.",
        metavar="NAME",
        rich_help_panel=OBSTACLES,
    ),
]
Leaf = Annotated[
    float,
    typer.Option(
        help="Edge of the cells the cloud is thinned to, metres; 0 keeps every point.",
        rich_help_panel=OBSTACLES,
    ),
]
Radii = Annotated[
    bool,
    typer.Option(
        help="Keep off the points that thinning leaves out, too.", rich_help_panel=OBSTACLES
    ),
]
Clearance = Annotated[
    float,
    typer.Option(
        help="Least distance wanted between points and hulls, metres.", rich_help_panel=OBSTACLES
    ),
]
BaseCollision = Annotated[
    bool,
    typer.Option(
        help="Fail where a point is in a hull that no joint moves.", rich_help_panel=OBSTACLES
    ),
]
GoalsFile = Annotated[
    Path | None,
    typer.Option(
        "--goals",
        help="Instead of --target: requirements of any kind that are all to be met, YAML.",
        rich_help_panel=GOAL,
    ),
]
AnyFile = Annotated[
    Path | None,
    typer.Option(
        "--any",
        help="Instead of --target: poses any one of which will do, CSV with columns"
        " x y z qw qx qy qz, and cost where a first row names them.",
        rich_help_panel=GOAL,
    ),
]
Tool = Annotated[
    str | None,
    typer.Option(
        help="What of the tip has to be at the target, in the tip's frame, as --target:"
        ' "x y z roll pitch yaw".',
        metavar="POSE",
        rich_help_panel=GOAL,
    ),
]
Priority = Annotated[
    Literal["both", "position"],
    typer.Option(
        help="'position': the orientation as near as can be where both cannot be met.",
        rich_help_panel=GOAL,
    ),
]
Locks = Annotated[
    list[str] | None,
    typer.Option(
        "--lock",
        help="Joint that keeps a position, radians or metres; repeatable.",
        metavar="JOINT=VALUE",
        rich_help_panel=GOAL,
    ),
]
All = Annotated[
    bool,
    typer.Option(
        "--all", help="Find all distinct solutions, the nearest first.", rich_help_panel=SEARCH
    ),
]
Limit = Annotated[
    int | None,
    typer.Option(help="Of --all no more than this many solutions.", rich_help_panel=SEARCH),
]
