"""Problems of a family: scenes drawn until a valid configuration is found, kept in build/."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio

from bench.common.arrays import FloatArray
from bench.common.peer_library import ROOT
from bench.ik.problems.families import FAMILIES, Draft, Family
from bench.ik.problems.judge import Judge
from bench.ik.problems.problem import Problem, load, save
from bench.ik.problems.robots import RobotFiles, robot_files
from bench.ik.problems.sample_ik import configurations

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
    joint_names: Sequence[str] | None = None,
    told: Mapping[str, float] | None = None,
) -> list[Problem]:
    """The first `count` problems of a family, from the kept file if it has them.

    Problem k depends on the family, the robot, the seed and k alone. Its configuration is valid by
    the visual and by the collision meshes: published problems are valid by the latter. It is in the
    order of `joint_names`, or of Pinocchio's. Joints in `told` stand still there [rad], [m].

    Raises:
        FamilyError: The family is unknown, does not have the robot, or no scene is valid.
    """
    if family not in FAMILIES:
        raise FamilyError(f"family {family!r} is not one of {sorted(FAMILIES)}")
    kind = FAMILIES[family]
    if robot not in kind.robots:
        raise FamilyError(f"{family} has the robots {sorted(kind.robots)}, not {robot!r}")
    files = replace(robot_files(robot), told=told or {})
    held = "".join(f"-{name}={value:g}" for name, value in sorted(files.told.items()))
    file = kept / f"{family}-{robot}{held}-seed{seed}-v{RULES}.{kind.version}.json"
    problems = load(file) if file.is_file() else []
    if len(problems) < count:
        judges = judges_of(files)
        problems += [_make(kind, robot, judges, seed, k) for k in range(len(problems), count)]
        save(file, problems)
    if joint_names is None:
        return problems[:count]
    known = list(pinocchio.buildModelFromXML(files.xml()).names)[1:]
    order = [known.index(name) for name in joint_names]
    return [
        problem if problem.goal_q is None else replace(problem, goal_q=problem.goal_q[order])
        for problem in problems[:count]
    ]


def judges_of(files: RobotFiles, joint_names: Sequence[str] | None = None) -> tuple[Judge, Judge]:
    """Judges by the meshes that one sees, and by the coarser ones."""
    return Judge(files, "visual", joint_names), Judge(files, "collision", joint_names)


def _is_good(judges: Sequence[Judge], problem: Problem, q: FloatArray) -> bool:
    return all(judge.fault(problem, q) is None for judge in judges)


def with_valid_configuration(problem: Problem, judges: Sequence[Judge]) -> Problem:
    """The problem with a configuration that meets its targets and touches nothing, if one is found.

    All judges have to agree; goal_q is in the first one's order of joints. The same problem is
    always searched alike.
    """
    rng = np.random.default_rng(sum(problem.name.encode()))
    for q in configurations(judges[0], problem.targets, rng, CEILING_STARTS):
        if _is_good(judges, problem, q):
            return replace(problem, goal_q=q)
    return problem


def _make(family: Family, robot: str, judges: Sequence[Judge], seed: int, k: int) -> Problem:
    judge, tips = judges[0], judges[0].files.tips
    name = f"{family.name}-{robot}-{k:04d}"
    rng = np.random.default_rng([seed, sum(family.name.encode()), sum(robot.encode()), k])
    for _ in range(DRAWS):
        draft = family.draw(rng, family.robots[robot])
        wanted = {}
        if draft.grasp is not None:
            zero = np.zeros(judge.dof)  # both links are on the hand: any configuration would do
            T_grasp_tip = np.linalg.inv(judge.fk(zero, GRASP_LINK[robot])) @ judge.fk(zero, tips[0])
            wanted = {tips[0]: draft.grasp @ T_grasp_tip}
        problem = Problem(
            name=name,
            robot=robot,
            solids=tuple(draft.solids),
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


def _candidates(
    draft: Draft,
    judge: Judge,
    targets: Mapping[str, FloatArray],
    rng: np.random.Generator,
    starts: int,
) -> Iterator[FloatArray]:
    """Configurations that meet the targets; where there are none, postures to take them from."""
    if draft.grasp is not None:
        yield from configurations(judge, targets, rng, starts)
        return
    for _ in range(starts):
        q = judge.random(rng) if draft.posture is None else draft.posture(rng, judge.joint_names)
        if (q >= judge.lower).all() and (q <= judge.upper).all():
            yield q
