"""The peers that the library is compared with: what they claim holds, and they are not weak.

The compiled ones are taken from the folder that PDOIK_PEERS names, or built where the benchmarks
build them; the others are skipped where their packages are not installed (extra "peers").
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pdoik
from bench.common import peer_library
from bench.ik import experiment
from bench.ik.judges import recheck
from bench.ik.methods import compiled
from bench.ik.methods import hulls as hulls_module
from bench.ik.methods import problem as problem_module

Problem, Terms, Answer = problem_module.Problem, problem_module.Terms, problem_module.Answer
Make = Callable[[Any, Any], Any]

REPOSITORY = Path(__file__).parents[4]
COMPILED = ("PinocchioLm", "KdlLma")
TOLERANCE = 1e-3
SPHERE = 0.05  # radius of an obstacle [m]
BUILD = REPOSITORY / "build" / "bench"


@pytest.fixture(scope="module")
def libraries() -> Path:
    if "PDOIK_PEERS" in os.environ:
        return Path(os.environ["PDOIK_PEERS"])
    return peer_library.build_peers(BUILD)


@pytest.fixture(params=["PinocchioLm", "KdlLma", "ToolboxLm", "DrakeSnopt", "MinkQp"])
def make(request: pytest.FixtureRequest) -> Make:
    """A method's constructor."""
    name = request.param
    if name in COMPILED:
        libraries = request.getfixturevalue("libraries")
        method = getattr(compiled, name)
        return lambda arm, terms: method(arm, terms, libraries=libraries)
    module, package = {
        "ToolboxLm": ("toolbox_lm", "roboticstoolbox"),
        "DrakeSnopt": ("drake_snopt", "pydrake"),
        "MinkQp": ("mink_qp", "mink"),
    }[name]
    pytest.importorskip(package)
    return getattr(importlib.import_module(f"bench.ik.methods.{module}"), name)


@pytest.fixture(params=experiment.ARMS)
def arm(request: pytest.FixtureRequest) -> Any:
    return experiment.Arm.builtin(request.param)


def terms_of(goal: str = "pose", **changes: Any) -> Any:
    given = {
        "position_tolerance": TOLERANCE,
        "rotation_tolerance": TOLERANCE,
        "max_time": 2.0,
        "seed": 1,
    }
    return Terms(goal=goal, **(given | changes))


def options_of(terms: Any) -> pdoik.Options:
    return pdoik.Options(
        goal=terms.goal,
        position_tolerance=terms.position_tolerance,
        rotation_tolerance=terms.rotation_tolerance,
        clearance_tolerance=0.0,
    )


def random_problem(arm: Any, rng: np.random.Generator, spheres: int) -> Any:
    """A reachable pose, with spheres 1 to 5 cm from the configuration that defines it."""
    solver = pdoik.Solver(arm.robot, pdoik.Options())
    q = arm.random_configuration(rng)
    T = arm.robot.fk(q)
    points = np.empty((0, 4))
    while len(points) < spheres:
        point = np.append(rng.uniform((-1.2, -1.2, -0.6), (1.2, 1.2, 1.5)), SPHERE)
        if 0.01 <= solver.judge(T, q, point[None]).clearance <= 0.05:
            points = np.vstack([points, point])
    return Problem(T_base_tip=T, q0=arm.robot.mid_configuration(), points=points)


def holds(arm: Any, terms: Any, problem: Any, q: np.ndarray) -> bool:
    """By NumPy from the URDF; that the spheres are clear by their distances to the hulls."""
    options = options_of(terms)
    chain = recheck.UrdfChain(arm.urdf, arm.robot.joint_names)
    centers = problem.points[:, :3]
    verdict = recheck.recheck(chain, arm.robot, options, problem.T_base_tip, q, centers)
    clear = pdoik.Solver(arm.robot, options).judge(problem.T_base_tip, q, problem.points).clearance
    return verdict.confirms(options) and clear >= 0


def test_claims_hold_and_are_many(make: Make, arm: Any) -> None:
    terms = terms_of()
    method = make(arm, terms)
    rng = np.random.default_rng(3)
    problems = [random_problem(arm, rng, spheres) for spheres in (0, 9) for _ in range(3)]
    answers = [method.solve(problem) for problem in problems]
    for problem, answer in zip(problems, answers, strict=True):
        assert isinstance(answer, Answer)
        assert not answer.claimed or holds(arm, terms, problem, answer.q)
        assert answer.time > 0
    assert sum(answer.claimed for answer in answers) >= 5
    assert all(answer.claimed for answer in answers[:3])


def test_axis_goals_are_solved_or_refused(make: Make) -> None:
    arm, terms = experiment.Arm.builtin("panda"), terms_of("axis")
    try:
        method = make(arm, terms)
    except ValueError as refusal:
        assert "whole poses only" in str(refusal)  # noqa: PT017
        return
    rng = np.random.default_rng(4)
    for spheres in (0, 9):
        problem = random_problem(arm, rng, spheres)
        answer = method.solve(problem)
        assert answer.claimed
        assert holds(arm, terms, problem, answer.q)
    freely = options_of(terms_of())
    assert not recheck.recheck(
        recheck.UrdfChain(arm.urdf, arm.robot.joint_names),
        arm.robot,
        freely,
        problem.T_base_tip,
        answer.q,
        np.empty((0, 3)),
    ).confirms(freely), "the tip's turn about z should be free"


def test_what_is_out_of_reach_is_not_claimed(make: Make) -> None:
    arm = experiment.Arm.builtin("panda")
    T = np.eye(4)
    T[:3, 3] = 5.0
    problem = Problem(T_base_tip=T, q0=arm.robot.mid_configuration())
    answer = make(arm, terms_of(max_time=0.02)).solve(problem)
    assert not answer.claimed
    assert answer.q.shape == (arm.robot.dof,)
    assert answer.time < 1.0


@pytest.mark.parametrize("name", COMPILED)
def test_a_seed_gives_one_answer(name: str, libraries: Path) -> None:
    arm = experiment.Arm.builtin("panda")
    method = getattr(compiled, name)
    rng = np.random.default_rng(5)
    problems = [random_problem(arm, rng, 9) for _ in range(5)]

    def answers(seed: int) -> list[list[float]]:
        peer = method(arm, terms_of(seed=seed), libraries=libraries)
        return [peer.solve(problem).q.tolist() for problem in problems]

    assert answers(1) == answers(1)
    assert answers(1) != answers(2)


class Touch:
    """A compiled peer's obstacle check: asked for where it stands, it moves only if it touches."""

    def __init__(self, arm: Any, name: str, libraries: Path) -> None:
        self._arm = arm
        method = getattr(compiled, name)
        self._peer = method(arm, terms_of(max_time=0.01), libraries=libraries)

    def __call__(self, q: np.ndarray, points: np.ndarray) -> bool | None:
        """None if it was held up so long that there was no second start."""
        problem = Problem(T_base_tip=self._arm.robot.fk(q), q0=q, points=points)
        answer = self._peer.solve(problem)
        if answer.restarts == 0 and not answer.claimed:
            return None
        return answer.restarts > 0


@pytest.mark.parametrize("columns", [3, 4])
@pytest.mark.parametrize("name", COMPILED)
def test_the_obstacle_check_agrees_with_the_librarys(
    name: str, columns: int, arm: Any, libraries: Path
) -> None:
    touches = Touch(arm, name, libraries)
    solver = pdoik.Solver(arm.robot, pdoik.Options())
    rng = np.random.default_rng(6)
    seen = {True: 0, False: 0}
    for _ in range(100):
        q = arm.random_configuration(rng)
        points = rng.uniform((-0.7, -0.7, 0, 0), (0.7, 0.7, 1.2, 0.1), (30, 4))[:, :columns]
        points[: len(points) - 4, 3:] = 0  # four with a radius
        found = touches(q, points)
        if found is None:
            continue
        assert found == (solver.judge(arm.robot.fk(q), q, points).clearance < 0)
        seen[found] += 1
    assert min(seen.values()) >= 10, seen


@pytest.mark.parametrize("name", COMPILED)
def test_the_obstacle_check_is_exact(name: str, arm: Any, libraries: Path) -> None:
    touches = Touch(arm, name, libraries)
    solver = pdoik.Solver(arm.robot, pdoik.Options())
    rng = np.random.default_rng(7)
    outcomes = []
    for _ in range(40):
        q = arm.random_configuration(rng)
        point = rng.uniform((-0.7, -0.7, 0), (0.7, 0.7, 1.2))
        distance = solver.judge(arm.robot.fk(q), q, point[None]).clearance
        if distance > 1e-3:
            clear, touching = (np.append(point, distance + gap)[None] for gap in (-1e-8, 1e-8))
            outcomes += [(touches(q, clear), False), (touches(q, touching), True)]
    outcomes = [(found, expected) for found, expected in outcomes if found is not None]
    assert len(outcomes) >= 40
    assert all(found == expected for found, expected in outcomes)


def test_drakes_spheres_cover_the_hulls(arm: Any) -> None:
    covering_spheres = importlib.import_module("bench.ik.methods.drake_snopt").covering_spheres
    angle = np.linspace(0, np.pi, 2001)
    for hull in hulls_module.hulls_of(arm.robot):
        a, b = hull.semi_major, hull.semi_minor
        surface = np.column_stack([a * np.cos(angle), b * np.sin(angle)])  # half a meridian
        spheres = covering_spheres(hull)
        depth = [radius - np.hypot(surface[:, 0] - x, surface[:, 1]) for x, radius in spheres]
        assert np.max(depth, axis=0).min() >= 0
        assert np.max(depth, axis=0).max() < 0.02  # [m]
        assert max(abs(place) + radius for place, radius in spheres) < a + 0.01


@pytest.mark.parametrize("shape", [(2, 2), (3,), (1, 5)])
def test_obstacles_of_another_shape_are_refused(shape: tuple[int, ...], libraries: Path) -> None:
    arm = experiment.Arm.builtin("panda")
    method = compiled.PinocchioLm(arm, terms_of(), libraries=libraries)
    q = arm.robot.mid_configuration()
    problem = Problem(T_base_tip=arm.robot.fk(q), q0=q, points=np.zeros(shape))
    with pytest.raises(ValueError, match="expected"):
        method.solve(problem)
