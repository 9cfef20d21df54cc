"""Problems of a family: scenes drawn until a valid configuration is found, kept in build/."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio

from bench.common.peer_library import ROOT
from bench.ik.problems.families import FAMILIES
from bench.ik.problems.families.family import Draft, Family
from bench.ik.problems.judge import Judge
from bench.ik.problems.problem import Problem, load, save
from bench.ik.problems.robots import RobotFiles, robot_files
from bench.ik.problems.sample_ik import FloatArray, configurations

KEPT = ROOT / "build/bench/problems/made"
RULES = 2  # counts up when it changes what is a valid configuration
STARTS = 60  # of the search for a valid configuration
CEILING_STARTS = 300  # the same where the share that can be reached at all is asked for
DRAWS = 200  # scenes in a row without a valid configuration, then it gives up
GRASP_LINK = {"panda": "panda_link8", "ur5": "ee_link", "ur10": "tool0"}  # whose pose drafts give


class FamilyError(RuntimeError):
    """No problems could be made as asked."""


def problems_of(
    family: str,
    robot: str,
    count: int,
    seed: int = 0,
    kept: Path = KEPT,
    advance: Callable[[], object] = lambda: None,
    joint_names: Sequence[str] | None = None,
) -> list[Problem]:
    """The first `count` problems of a family, from the kept file if it has them.

    Problem k depends on the family, the robot, the seed and k alone. Its configuration is valid by
    the visual and by the collision meshes: published problems are valid by the latter.

    Args:
        family: One of FAMILIES.
        robot: One of the family's robots.
        count: How many.
        seed: Of all of them.
        kept: Folder of the files.
        advance: Called after each problem that had to be made.
        joint_names: The order of goal_q; None for Pinocchio's.

    Raises:
        FamilyError: The family is unknown, does not have the robot, or no scene is valid.
    """
    if family not in FAMILIES:
        raise FamilyError(f"family {family!r} is not one of {sorted(FAMILIES)}")
    kind = FAMILIES[family]
    if robot not in kind.robots:
        raise FamilyError(f"{family} has the robots {sorted(kind.robots)}, not {robot!r}")
    file = kept / f"{family}-{robot}-seed{seed}-v{RULES}.{kind.version}.json"
    problems = load(file) if file.is_file() else []
    if len(problems) < count:
        judges = judges_of(robot_files(robot))
        for k in range(len(problems), count):
            problems.append(_make(kind, robot, judges, seed, k))
            advance()
        save(file, problems)
    if joint_names is None:
        return problems[:count]
    known = list(pinocchio.buildModelFromXML(robot_files(robot).xml()).names)[1:]
    order = [known.index(name) for name in joint_names]
    return [
        problem if problem.goal_q is None else replace(problem, goal_q=problem.goal_q[order])
        for problem in problems[:count]
    ]


def judges_of(files: RobotFiles, joint_names: Sequence[str] | None = None) -> tuple[Judge, Judge]:
    """By the meshes that one sees, and by the coarser ones."""
    return Judge(files, "visual", joint_names), Judge(files, "collision", joint_names)


def _is_good(judges: Sequence[Judge], problem: Problem, q: FloatArray) -> bool:
    return all(judge.is_good(problem, q) for judge in judges)


def with_valid_configuration(problem: Problem, judges: Sequence[Judge], starts: int) -> Problem:
    """The problem with a configuration that meets its targets and touches nothing, if one is found.

    Args:
        problem: Without goal_q.
        judges: Of its robot, who all have to agree; goal_q is in the first one's order of joints.
        starts: Random ones of the search; the same problem is always searched alike.
    """
    rng = np.random.default_rng(sum(problem.name.encode()))
    for q in configurations(judges[0], problem.targets, rng, starts):
        if _is_good(judges, problem, q):
            return replace(problem, goal_q=q)
    return problem


def _make(family: Family, robot: str, judges: Sequence[Judge], seed: int, k: int) -> Problem:
    judge = judges[0]
    name = f"{family.name}-{robot}-{k:04d}"
    rng = np.random.default_rng([seed, sum(family.name.encode()), sum(robot.encode()), k])
    tips = judge.files.tips
    for _ in range(DRAWS):
        draft = family.draw(rng, family.robots[robot])
        wanted = {}
        if draft.grasp is not None:
            wanted = {tips[0]: draft.grasp @ _grasp_to_tip(judge, robot, tips[0])}
        problem = Problem(
            name=name,
            robot=robot,
            solids=draft.solids,
            targets=wanted,
            allowed=draft.allowed,
            contacts=dict(draft.contacts),
        )
        starts = CEILING_STARTS if family.contact else STARTS
        for q in _candidates(draft, judge, wanted, rng, starts):
            if _is_good(judges, problem, q):
                return replace(problem, goal_q=q, targets={tip: judge.fk(q, tip) for tip in tips})
        if family.contact:
            return problem
    raise FamilyError(f"{name}: none of {DRAWS} scenes has a valid configuration")


def _grasp_to_tip(judge: Judge, robot: str, tip: str) -> FloatArray:
    """T_grasp_tip, a constant: both links are on the hand."""
    q = np.zeros(judge.dof)
    return np.asarray(np.linalg.inv(judge.fk(q, GRASP_LINK[robot])) @ judge.fk(q, tip))


def _candidates(
    draft: Draft,
    judge: Judge,
    targets: dict[str, FloatArray],
    rng: np.random.Generator,
    starts: int,
) -> Iterator[FloatArray]:
    """Configurations that meet the targets; where there are none, postures to take them from."""
    if draft.grasp is not None:
        yield from configurations(judge, targets, rng, starts)
        return
    for _ in range(starts):
        if draft.posture is None:
            yield judge.random(rng)
        else:
            q = draft.posture(rng, judge.joint_names)
            if (q >= judge.lower).all() and (q <= judge.upper).all():
                yield q
