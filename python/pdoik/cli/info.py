"""pdoik info: what a robot is, as the solver sees it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

import pdoik

from .messages import out, warn
from .robots import PackageDirs, RobotArgument, XacroArguments, load_robot
from .tables import json_text, limit_text


def info(
    robot: RobotArgument,
    base_link: Annotated[str | None, typer.Option(help="First link; the root otherwise.")] = None,
    tip_link: Annotated[str | None, typer.Option(help="Last link; every leaf otherwise.")] = None,
    occupancy: Annotated[Path | None, typer.Option(help="Hulls of the robot, YAML.")] = None,
    package_dir: PackageDirs = None,
    xacro_arg: XacroArguments = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Show a robot's joints, limits, links, tips and hulls.

    [bold]Example[/]: pdoik info arm.urdf --tip-link tool0
    """
    loaded = load_robot(
        robot, base_link, tip_link, occupancy, packages=package_dir, arguments=xacro_arg
    )
    if json:
        out.print(json_text(_facts(loaded)), highlight=False, markup=False)
        return
    _print(loaded)
    for line in loaded.warnings:
        warn(line)


def _facts(robot: pdoik.Robot) -> dict[str, object]:
    return {
        "name": robot.name,
        "dof": robot.dof,
        "joint_names": list(robot.joint_names),
        "lower": robot.lower,
        "upper": robot.upper,
        "base_link": robot.base_link,
        "tip_links": list(robot.tip_links),
        "link_names": list(robot.link_names),
        "spheres": len(robot.occupancy.spheres),
        "spheroids": len(robot.occupancy.spheroids),
        "capsules": len(robot.occupancy.capsules),
        "warnings": list(robot.warnings),
    }


def _print(robot: pdoik.Robot) -> None:
    joints = Table("joint", title=f"{escape(robot.name)}: {robot.dof} joints", title_justify="left")
    joints.add_column("type")
    for name in ("lower", "upper"):
        joints.add_column(name, justify="right")
    rows = zip(robot.joint_names, robot.joint_types, robot.lower, robot.upper, strict=True)
    for name, kind, lower, upper in rows:
        joints.add_row(escape(name), kind, limit_text(lower, kind), limit_text(upper, kind))
    out.print(joints)

    rest = Table.grid(padding=(0, 2))
    rest.add_row("base link", escape(robot.base_link))
    rest.add_row("tip links", escape(", ".join(robot.tip_links)))
    rest.add_row("links", escape(", ".join(robot.link_names)))
    occupancy = robot.occupancy
    counts = {
        "spheres": len(occupancy.spheres),
        "spheroids": len(occupancy.spheroids),
        "capsules": len(occupancy.capsules),
    }
    hulls = (
        ", ".join(f"{count} {kind}" for kind, count in counts.items())
        if len(occupancy)
        else ("none: the solver cannot see obstacles; see pdoik occupancy --help")
    )
    rest.add_row("hulls", hulls)
    out.print(rest)
