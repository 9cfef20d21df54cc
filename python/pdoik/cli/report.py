"""The outcome of a solve, for people and for programs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from rich import box
from rich.markup import escape
from rich.table import Table

import pdoik

from .messages import out, warn
from .obstacles import Obstacles
from .tables import angle_text, length_text, time_text

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """A result beside what it is a result of."""

    robot: pdoik.Robot
    options: pdoik.Options
    T_base_tip: FloatArray  # (4, 4)
    result: pdoik.Result
    obstacles: Obstacles | None = None
    surface_clearance: float = math.inf  # with the cloud before it was thinned [m]


_MEANING = {
    "solved": "solved: pose, limits and clearance hold to their tolerances",
    "time_limit": "not solved: the time ran out; this is the best found",
    "exhausted": "not solved: every start ended in a local minimum; this is the best found",
    "out_of_reach": "not solved: the target is farther than the arm stretches; this is the nearest",
    "base_collision": "not solved: an obstacle is inside a hull that no joint moves",
    "blocked": "not solved: every start ends in the same obstacle",
}


def facts(solution: Solution) -> dict[str, object]:
    """Everything in a solution, for JSON; SI units."""
    robot, options, result = solution.robot, solution.options, solution.result
    obstacles = solution.obstacles
    cloud = scene = None
    if obstacles is not None and obstacles.scene is not None:
        scene = {
            "file": str(obstacles.scene.path),
            "shapes": [shape.name for shape in obstacles.shapes],
            "points": len(obstacles.scene.surface),
        }
    if obstacles is not None and len(obstacles.surface):
        cloud = {
            "file": str(obstacles.file),
            "points": len(obstacles.surface),
            "leaf": obstacles.leaf,
            "obstacles": len(obstacles.cloud),
            "clearance_before_thinning": solution.surface_clearance,
        }
    return {
        "robot": robot.name,
        "base_link": robot.base_link,
        "tip_link": robot.tip_links[0],
        "joint_names": list(robot.joint_names),
        "goal": options.goal,
        "T_base_tip": solution.T_base_tip,
        "q": result.q,
        "success": result.success,
        "status": result.status,
        "position_error": result.position_error,
        "rotation_error": result.rotation_error,
        "clearance": result.clearance,
        "center_of_mass": result.center_of_mass,
        "balance_violation": result.balance_violation,
        "self_distance": result.self_distance,
        "limit_violation": result.limit_violation,
        "worst_constraint": result.worst_constraint,
        "worst_violation": result.worst_violation,
        "forgiven_contact": result.forgiven_contact,
        "forgiven_depth": result.forgiven_depth,
        "iterations": result.iterations,
        "evaluations": result.evaluations,
        "restarts": result.restarts,
        "intake": result.intake,
        "late_evaluations": result.late_evaluations,
        "time": result.time,
        "cloud": cloud,
        "scene": scene,
    }


def print_report(solution: Solution) -> None:
    """Two tables: the joints, and how good they are; then what to try when it failed."""
    result = solution.result
    color = "green" if result.success else "red"
    out.print(f"[bold {color}]{_MEANING.get(result.status, escape(result.status))}[/]")
    out.print(_joints(solution))
    out.print(_errors(solution))
    for line in advice(solution):
        out.print(f"[bold]try[/] {escape(line)}", highlight=False)
    obstacles = solution.obstacles
    wanted = solution.options.clearance
    if result.success and obstacles is not None and solution.surface_clearance < wanted - 1e-6:
        missing = wanted - solution.surface_clearance
        warn(
            f"points that --leaf {obstacles.leaf:g} left out are {length_text(missing)} nearer than"
            " wanted: try --radii, a smaller --leaf,"
            f" or --clearance {_rounded_up(wanted + missing)}"
        )


def _rounded_up(metres: float) -> str:
    return f"{math.ceil(1e3 * metres) / 1e3:g}"


def _joints(solution: Solution) -> Table:
    robot = solution.robot
    unit = "rad or m" if "prismatic" in robot.joint_types else "rad"
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("joint", no_wrap=True)
    for name in (f"position {unit}", "degrees", f"lower {unit}", f"upper {unit}", "to limit"):
        table.add_column(name, justify="right")
    rows = zip(
        robot.joint_names,
        robot.joint_types,
        solution.result.q,
        robot.lower,
        robot.upper,
        strict=True,
    )
    for name, kind, q, lower, upper in rows:
        turns = kind != "prismatic"
        room = min(q - lower, upper - q)
        ends = [f"{end:+.4f}" if math.isfinite(end) else "none" for end in (lower, upper)]
        to_limit = ""
        if math.isfinite(room):
            to_limit = f"{math.degrees(room):.1f}°" if turns else f"{room:.4f} m"
        degrees = f"{math.degrees(q):.2f}°" if turns else ""
        table.add_row(escape(name), f"{q:+.6f}", degrees, *ends, to_limit)
    return table


def _errors(solution: Solution) -> Table:
    result, options, obstacles = solution.result, solution.options, solution.obstacles
    table = Table.grid(padding=(0, 2))

    def add(what: str, value: str, remark: str = "") -> None:
        table.add_row(what, value, f"[dim]{escape(remark)}[/]")

    add(
        "position error",
        length_text(result.position_error),
        f"tolerance {length_text(options.position_tolerance)}",
    )
    if options.goal != "position":
        tolerance = f"tolerance {angle_text(options.rotation_tolerance)}"
        add("rotation error", angle_text(result.rotation_error), tolerance)
    if obstacles is not None:
        what = f"to {_counts(obstacles)}, wanted {length_text(options.clearance)}"
        add("clearance", length_text(result.clearance), what)
        if len(obstacles.cloud) != len(obstacles.surface):
            what = f"to all {len(obstacles.surface)} points of {obstacles.file.name}"
            add("", length_text(solution.surface_clearance), what)
    if math.isfinite(result.self_distance):
        add("between links", length_text(result.self_distance), "least distance of their hulls")
    add("tightest" if result.success else "worst", escape(result.worst_constraint))
    if result.forgiven_contact:
        add("forgiven", length_text(result.forgiven_depth), f"at most, {result.forgiven_contact}")
    effort = f"{result.iterations} iterations, {result.evaluations} evaluations, "
    add("time", time_text(result.time), effort + f"{result.restarts} restarts")
    return table


def _counts(obstacles: Obstacles) -> str:
    """How many points and shapes there are."""
    counts = {"points": len(obstacles.cloud), "shapes": len(obstacles.shapes)}
    named = [f"{n} {what if n > 1 else what[:-1]}" for what, n in counts.items() if n]
    return " and ".join(named) or "nothing"


def advice(solution: Solution) -> list[str]:
    """What may help after a failure, most promising first."""
    result, options = solution.result, solution.options
    if result.success:
        return []
    looser = {
        "pose": "--goal axis or --goal position, if the tool may turn about its axis or freely",
        "axis": "--goal position, if the tool's direction does not matter",
    }
    tips = []
    if result.status == "out_of_reach":
        tips.append(
            "a target nearer to the robot; positions are in metres in the base link's frame"
        )
    elif result.status == "base_collision":
        tips.append(
            "removing the robot's own points from the cloud, and checking that obstacles are in the"
            f" frame of {solution.robot.base_link}, in metres; or --no-base-collision, if the"
            " robot stands on what it shows"
        )
    elif result.status == "blocked":
        tips.append("another target, or the obstacles without what the tool is to touch")
    else:
        if options.method == "paper":
            tips.append("--method default, which starts again where the paper's method gives up")
        elif result.status == "time_limit":
            tips.append(f"--max-time {10 * options.max_time:g}, ten times as long")
        else:
            n_starts = options.max_restarts + 1
            tips.append(f"another target: after {n_starts} starts this one may have no solution")
            tips.append(f"--max-restarts {10 * n_starts} with a longer --max-time")
        if result.self_distance < options.self_clearance - options.clearance_tolerance:
            tips.append(
                "--srdf with the pairs of links that may touch (pdoik pairs finds them), or"
                " --no-self-collision"
            )
        if options.goal in looser:
            tips.append(looser[options.goal])
    if result.status in {"base_collision", "blocked"} and not options.forgive_overhang:
        tips.append(
            "--forgive-overhang, if it touches by no more than its hulls stand beyond its links"
        )
    if solution.obstacles is not None and result.status not in {"out_of_reach", "base_collision"}:
        given = "--cloud" if solution.obstacles.scene is None else "--scene"
        tips.append(f"the same without {given}, which tells whether obstacles are in the way")
    tips.append("--report case.json, if it should have been solved: a file to send with an issue")
    return tips
