"""Problems of a family: scenes drawn until a valid configuration is found, kept in build/."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench.problems.families import FAMILIES
from bench.problems.families.family import Draft, Family, Placement
from bench.problems.judge import Judge
from bench.problems.problem import Problem, load, save
from bench.problems.robots import robot_files
from bench.problems.sample_ik import FloatArray, configurations

from peer_library import ROOT

KEPT = ROOT / "build/bench/problems/made"
STARTS = 60  # of the search for a valid configuration
CEILING_STARTS = 300  # the same where the share that can be reached at all is asked for
DRAWS = 200  # scenes in a row without a valid configuration, then it gives up
GRASP_LINK = {"panda": "panda_link8", "ur5": "ee_link", "ur10": "tool0"}  # whose pose drafts give
VERSION = 1  # of what is made; counts up when the same seed gives other problems


class FamilyError(RuntimeError):
    """No problems could be made as asked."""


def problems_of(
    family: str,
    robot: str,
    count: int,
    seed: int = 0,
    kept: Path = KEPT,
    advance: Callable[[], object] = lambda: None,
) -> list[Problem]:
    """The first `count` problems of a family, from the kept file if it has them.

    Problem k depends on the family, the robot, the seed and k alone.

    Args:
        family: One of FAMILIES.
        robot: One of the family's robots.
        count: How many.
        seed: Of all of them.
        kept: Folder of the files.
        advance: Called after each problem that had to be made.

    Raises:
        FamilyError: The family is unknown, does not have the robot, or no scene is valid.
    """
    if family not in FAMILIES:
        raise FamilyError(f"family {family!r} is not one of {sorted(FAMILIES)}")
    kind = FAMILIES[family]
    if robot not in kind.robots:
        raise FamilyError(f"{family} has the robots {sorted(kind.robots)}, not {robot!r}")
    file = kept / f"{family}-{robot}-seed{seed}-v{VERSION}.json"
    problems = load(file) if file.is_file() else []
    if len(problems) < count:
        judge = Judge(robot_files(robot), "visual")
        for k in range(len(problems), count):
            problems.append(_make(kind, robot, judge, seed, k))
            advance()
        save(file, problems)
    return problems[:count]


def _make(family: Family, robot: str, judge: Judge, seed: int, k: int) -> Problem:
    name = f"{family.name}-{robot}-{k:04d}"
    rng = np.random.default_rng([seed, sum(family.name.encode()), sum(robot.encode()), k])
    tip = judge.files.tips[0]
    for _ in range(DRAWS):
        draft = family.draw(rng, family.robots[robot])
        if draft.grasp is None:
            q = _valid_posture(draft, judge, rng)
            targets = {} if q is None else {tip: judge.fk(q, tip)}
        else:
            wanted = {tip: draft.grasp @ _grasp_to_tip(judge, robot, tip)}
            starts = CEILING_STARTS if family.contact else STARTS
            q = _valid(draft, judge, wanted, rng, starts)
            targets = wanted if q is None else {tip: judge.fk(q, tip)}
        if q is not None or family.contact:
            return Problem(
                name=name,
                robot=robot,
                solids=draft.solids,
                targets=targets,
                goal_q=q,
                allowed=draft.allowed,
            )
    raise FamilyError(f"{name}: none of {DRAWS} scenes has a valid configuration")


def _grasp_to_tip(judge: Judge, robot: str, tip: str) -> FloatArray:
    """T_grasp_tip, a constant: both links are on the hand."""
    q = np.zeros(judge.dof)
    return np.asarray(np.linalg.inv(judge.fk(q, GRASP_LINK[robot])) @ judge.fk(q, tip))


def _valid(
    draft: Draft,
    judge: Judge,
    targets: dict[str, FloatArray],
    rng: np.random.Generator,
    starts: int,
) -> FloatArray | None:
    for q in configurations(judge, targets, rng, starts):
        if judge.touching(q, draft.solids, draft.allowed) is None:
            return q
    return None


def _valid_posture(draft: Draft, judge: Judge, rng: np.random.Generator) -> FloatArray | None:
    for _ in range(STARTS):
        q = judge.random(rng)
        if judge.touching(q, draft.solids, draft.allowed) is None:
            return q
    return None


__all__ = ["FamilyError", "Placement", "problems_of"]
