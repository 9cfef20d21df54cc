"""The outcome of a solve for people: tables, and what to try."""

from __future__ import annotations

import math
from collections.abc import Callable

from rich import box
from rich.markup import escape
from rich.table import Table

from pdoik.reports import Call, Requirement
from pdoik.reports import requirements as requirements_of

from .advice import advice
from .messages import out, warn
from .obstacles import Obstacles
from .solution import Solution
from .tables import angle_text, length_text, time_text

_MEANING = {
    "solved": "solved: pose, limits and clearance hold to their tolerances",
    "time_limit": "not solved: the time ran out; this is the best found",
    "exhausted": "not solved: every start ended in a local minimum; this is the best found",
    "out_of_reach": "not solved: the target is farther than the arm stretches; this is the nearest",
    "base_collision": "not solved: an obstacle is inside a hull that no joint moves",
    "blocked": "not solved: every start ends in the same obstacle",
    "nearest": "not solved: the position is met, and the orientation as nearly as was found",
}


def print_report(solution: Solution) -> None:
    """Two tables: the joints, and how good they are; then what to try when it failed."""
    result = solution.result
    color = "green" if result.success else "red"
    out.print(f"[bold {color}]{_MEANING.get(result.status, escape(result.status))}[/]")
    if not result.success and result.message:
        out.print(escape(result.message), highlight=False)
    if solution.question.call == "solve_any":
        out.print(_which(solution), highlight=False)
    out.print(_joints(solution))
    out.print(_errors(solution))
    for line in advice(solution):
        out.print(f"[bold]try[/] {escape(line)}", highlight=False)
    obstacles = solution.obstacles
    if result.success and obstacles is not None and solution.surface_room < -1e-6:
        missing = -solution.surface_room
        warn(
            f"points that --leaf {obstacles.leaf:g} left out are {length_text(missing)} nearer than"
            " wanted: try --radii, a smaller --leaf,"
            f" or --clearance {_rounded_up(solution.options.clearance + missing)}"
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

    asked = requirements(solution)
    lengths = {goal.position_tolerance for goal in asked if goal.kind != "look_at"}
    angles = {goal.rotation_tolerance for goal in asked if goal.kind != "position"}
    if lengths:
        remark = f"tolerance {_range(lengths, length_text)}"
        add("position error", length_text(result.position_error), remark)
    if angles:
        remark = f"tolerance {_range(angles, angle_text)}"
        add("rotation error", angle_text(result.rotation_error), remark)
    if obstacles is not None:
        what = f"to {_counts(obstacles)}, wanted {length_text(options.clearance)}"
        add("clearance", length_text(result.clearance), what)
        if len(obstacles.cloud) != len(obstacles.surface):
            what = f"to all {len(obstacles.surface)} points of {obstacles.file.name}"
            add("", length_text(solution.surface_clearance), what)
    if math.isfinite(result.self_distance):
        add("between links", length_text(result.self_distance), "least distance of their hulls")
    add("tightest" if result.success else "worst", escape(result.worst_constraint))
    effort = f"{result.iterations} iterations, {result.evaluations} evaluations, "
    add("time", time_text(result.time), effort + f"{result.restarts} restarts")
    return table


def requirements(solution: Solution) -> list[Requirement]:
    """The goals that have errors, with their tolerances."""
    goals = solution.question.met(solution.result)
    all_goals = requirements_of(goals, solution.robot.tip_links, solution.options, Call())
    return [goal for goal in all_goals if not goal.is_wish and goal.kind != "center_of_mass"]


def _range(values: set[float], text: Callable[[float], str]) -> str:
    least, most = min(values), max(values)
    return text(least) if least == most else f"{text(least)} to {text(most)}"


def _which(solution: Solution) -> str:
    """Name, of several poses, the one that is met, or that it came nearest to."""
    question, k = solution.question, solution.result.goal_index
    cost = "" if question.costs is None else f", at a cost of {question.costs[k]:g}"
    return f"pose {k + 1} of {len(question.goals)} in {escape(str(question.file))}{cost}"


def _counts(obstacles: Obstacles) -> str:
    """How many points and shapes there are."""
    counts = {"points": len(obstacles.cloud), "shapes": len(obstacles.shapes)}
    named = [f"{n} {what if n > 1 else what[:-1]}" for what, n in counts.items() if n]
    return " and ".join(named) or "nothing"
