"""What pdoik solve asks: one target, goals of a file, any of many poses; once or for all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

import pdoik

from .grasp_file import read_grasp_file
from .messages import fail, misuse_fails, warn_of_degrees
from .robots import numbers
from .target import parse_target

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A call of a solver, but for obstacles.

    Attributes:
        call: The method.
        goals: As it takes them: a target (4, 4), a list of Goals, or poses (N, 4, 4).
        file: That they are from.
        costs: Of `solve_any`, (N,).
        limit: Of `solve_all`.
        q0: Where to start, (n,).
        lock: Joints that keep a position [rad] or [m].
    """

    call: Literal["solve", "solve_any", "solve_all"]
    goals: Any
    file: Path | None = None
    costs: FloatArray | None = None
    limit: int | None = None
    q0: FloatArray | None = None
    lock: dict[str, float] = field(default_factory=dict)

    def keywords(self) -> dict[str, Any]:
        """Keyword arguments of the method."""
        keywords: dict[str, Any] = {"q0": self.q0, "lock": self.lock or None}
        if self.call == "solve_any":
            keywords["costs"] = self.costs
        if self.call == "solve_all":
            keywords["limit"] = self.limit
        return keywords

    def ask(self, solver: pdoik.Solver, obstacles: Any) -> Any:
        """A Result, or Solutions."""
        call = getattr(solver, self.call)
        return call(self.goals, obstacles=obstacles, **self.keywords())

    def met(self, result: pdoik.Result) -> Any:
        """The goals that a result is about."""
        return self.goals[result.goal_index] if self.call == "solve_any" else self.goals

    def target(self, result: pdoik.Result) -> FloatArray | None:
        """The one pose that a result is about, (4, 4) in the base frame; None if it is none."""
        met = self.met(result)
        if not isinstance(met, list):
            return np.asarray(met)
        places = ("pose", "axis", "position")
        hard = [goal for goal in met if goal.type in places and not goal.soft]
        if len(hard) != 1 or hard[0].relative_to is not None:
            return None
        return np.asarray(hard[0].T_base_tip)


def check_goals(target: str | None, goals: Path | None, any_: Path | None, is_all: bool) -> None:
    """Leave with status 2 where not one of them is given."""
    given = {"--target": target, "--goals": goals, "--any": any_}
    named = [option for option, value in given.items() if value is not None]
    if len(named) > 1:
        fail(f"{' and '.join(named)}: expected one of them")
    if not named:
        fail('no goal given: pdoik solve ROBOT --target "x y z qx qy qz qw", --goals or --any')
    if any_ is not None and is_all:
        fail("--all: expected with --target or --goals; of --any it would be those of each")


def tips_of(
    goals: list[pdoik.Goal], robot: pdoik.Robot, file: Path | None, tip_link: str | None
) -> list[str]:
    """The tips that a file names, if the robot has to be read once more to have them."""
    named: dict[str, str] = {}
    for k, each in enumerate(goals):
        for name in ("tip", "relative_to"):
            link = getattr(each, name)
            if link is not None:
                named.setdefault(link, f"{file}: goals[{k}].{name}")
    new = {link: entry for link, entry in named.items() if link not in robot.tip_links}
    for link, entry in new.items():
        if link not in robot.link_names:
            fail(f"{entry}: expected a link of {robot.name}, got {link!r}")
        if tip_link is not None:
            fail(f"{entry}: expected the tip that --tip-link names, {tip_link!r}, got {link!r}")
    tips = list(named) if new else list(robot.tip_links)
    for k, each in enumerate(goals):
        if len(tips) > 1 and each.tip is None and each.type != "center_of_mass":
            fail(f"{file}: goals[{k}].tip: is missing, expected one of {', '.join(tips)}")
    return tips if new else []


def robot_for(
    read: Callable[[list[str] | None], pdoik.Robot],
    goals: list[pdoik.Goal] | None,
    file: Path | None,
    tip_link: str | None,
) -> pdoik.Robot:
    """Robot with the tips of a file's goals; `read` takes their names, None for what it has."""
    loaded = read(None if tip_link is None else [tip_link])
    if goals is not None and (named := tips_of(goals, loaded, file, tip_link)):
        loaded = read(named)
    return loaded


def tool_of(tool: str | None, robot: pdoik.Robot, of_several: str) -> FloatArray:
    """Tool on the tip, (4, 4); leaves with status 2 where there are several tips."""
    if tool is None:
        return np.eye(4)
    if len(robot.tip_links) > 1:
        fail(f"--tool: expected a robot with one tip; of several {of_several} says it by tip")
    with misuse_fails("--tool"):
        return parse_target(tool, "pose", "--tool")


def joints_of(option: str, text: str | None, robot: pdoik.Robot) -> FloatArray | None:
    """A configuration that an option gives, (n,), or None."""
    if text is None:
        return None
    with misuse_fails(option):
        q = numbers(text, robot)
    warn_of_turns(option, robot, dict(zip(robot.joint_names, q.tolist(), strict=True)))
    return q


def question_of(
    target: str | None,
    goals: list[pdoik.Goal] | None,
    goals_file: Path | None,
    any_file: Path | None,
    robot: pdoik.Robot,
    *,
    goal: str,
    is_all: bool,
    limit: int | None,
    q0: str | None,
    lock: list[str] | None,
) -> Question:
    """What the options of `pdoik solve` say; leaves with status 2 where one makes no sense."""
    start = joints_of("--q0", q0, robot)
    call: Literal["solve", "solve_any", "solve_all"] = "solve_all" if is_all else "solve"
    asked: Any = goals
    costs = None
    if any_file is not None:
        call = "solve_any"
        with misuse_fails():
            asked, costs = read_grasp_file(any_file)
    elif target is not None:
        with misuse_fails("--target"):
            asked = parse_target(target, goal)
    return Question(
        call=call,
        goals=asked,
        file=goals_file or any_file,
        costs=costs,
        limit=limit,
        q0=start,
        lock=locks_of(lock, robot),
    )


def locks_of(given: Sequence[str] | None, robot: pdoik.Robot) -> dict[str, float]:
    """Positions that --lock gives, by joint; leaves with status 2 where it is none."""
    found: dict[str, float] = {}
    for text in given or ():
        joint, _, word = text.partition("=")
        if joint not in robot.joint_names:
            joints = ", ".join(robot.joint_names)
            fail(f"--lock: expected JOINT=VALUE of a joint, got {text!r}; there are {joints}")
        try:
            found[joint] = float(word)
        except ValueError:
            found[joint] = math.nan
        if not math.isfinite(found[joint]):
            fail(f"--lock: expected JOINT=VALUE with a finite number, got {text!r}")
        warn_of_turns("--lock", robot, found)
    return found


def warn_of_turns(option: str, robot: pdoik.Robot, positions: dict[str, float]) -> None:
    """Warn of degrees for joints that turn, see `warn_of_degrees`."""
    kinds = dict(zip(robot.joint_names, robot.joint_types, strict=True))
    warn_of_degrees(option, [q for joint, q in positions.items() if kinds[joint] != "prismatic"])
