"""Our own problem sets: valid by coal, the same for a seed, and counted as they should be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("coal")
pytest.importorskip("pinocchio")

from scipy.spatial import cKDTree

import pdoik
from bench.ik.problems.families import FAMILIES
from bench.ik.problems.judge import Judge
from bench.ik.problems.make import FamilyError, problems_of
from bench.ik.problems.methods import Method, MethodError, surface_cloud
from bench.ik.problems.problem import Problem
from bench.ik.problems.robots import robot_files
from bench.ik.problems.solids import box, pose
from bench.ik.problems.trials import row_of, run
from problem_sets import READY

PANDA = [name for name, family in FAMILIES.items() if "panda" in family.robots]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("made")


@pytest.fixture(scope="module")
def judge() -> Judge:
    return Judge(robot_files("panda"), "visual")


@pytest.mark.parametrize("family", PANDA)
def test_the_defining_configuration_is_clear_and_meets_its_target(
    family: str, kept: Path, judge: Judge
) -> None:
    (problem,) = problems_of(family, "panda", 1, kept=kept)
    assert problem.goal_q is not None
    assert judge.touching(problem.goal_q, problem.solids, problem.allowed) is None
    assert judge.misses(problem.goal_q, problem.targets, 1e-9, 1e-9) is None


def test_a_set_grows_without_changing(tmp_path: Path, kept: Path) -> None:
    (first,) = problems_of("flat_table", "panda", 1, kept=kept)
    again, second = problems_of("flat_table", "panda", 2, kept=tmp_path)
    np.testing.assert_array_equal(first.goal_q, again.goal_q)
    assert not np.allclose(first.goal_q, second.goal_q)


@pytest.mark.parametrize("name", ["table_top", "cubby_shelf", "barrel"])
def test_targets_on_surfaces_lie_on_what_the_tool_may_touch(
    name: str, rng: np.random.Generator
) -> None:
    family = FAMILIES[name]
    for _ in range(30):
        draft = family.draw(rng, family.robots["ur10"])
        carriers = {solid for _, solid in draft.allowed}
        assert len(carriers) == 1
        (carrier,) = (solid for solid in draft.solids if solid.name in carriers)
        surface = cKDTree(carrier.sample(0.01))
        assert surface.query(draft.grasp[:3, 3])[0] < 0.01
        ahead = draft.grasp @ [0, 0, 0.004, 1]  # the tool points into the carrier
        within = np.linalg.inv(carrier.T) @ ahead
        if carrier.kind == "box":
            assert (np.abs(within[:3]) <= np.array(carrier.size) / 2).all()
        else:
            radius, length = carrier.size
            assert np.hypot(*within[:2]) <= radius
            assert abs(within[2]) <= length / 2


def test_unknown_families_and_robots_are_named() -> None:
    with pytest.raises(FamilyError, match="family 'attic' is not one of"):
        problems_of("attic", "panda", 1)
    with pytest.raises(FamilyError, match="cage has the robots"):
        problems_of("cage", "ur10", 1)


@pytest.mark.parametrize("sink", [False, True])
def test_the_clouds_balls_hold_the_surface(sink: bool) -> None:
    wall = box("wall", (0.3, 0.2, 0.1), pose((0.5, 0, 0.3)))
    balls = surface_cloud([wall], sink=sink)
    points = wall.sample(0.0007)
    near, at = cKDTree(balls[:, :3]).query(points, k=20)
    assert (near - balls[at, 3]).min(axis=1).max() <= 1e-9


def test_shapes_are_the_solids_and_what_may_touch_is_told() -> None:
    robot = pdoik.Robot.builtin("panda")
    (problem,) = problems_of("flat_table", "panda", 1)
    scene, _ = Method("shapes", robot, [0.01], problem).take_in(problem)
    assert [shape.name for shape in scene.shapes] == [solid.name for solid in problem.solids]
    assert ("panda_link0", "table") in scene.allowed
    assert ("base_link", "table") not in scene.allowed, "the robot has no such link"
    with pytest.raises(MethodError, match="'guesses' is not one of"):
        Method("guesses", robot, [0.01])


def test_a_wrong_answer_and_a_missed_one_are_counted(judge: Judge) -> None:
    """A robot whose only hull holds next to nothing runs into what it cannot feel."""
    files = robot_files("panda")
    robot = pdoik.Robot.from_urdf(files.xml(), files.base, list(files.tips))
    robot.occupancy = pdoik.Occupancy(spheres=[(robot.base_link, (0, 0, 0), 1e-3)])
    q = np.array(READY)
    targets = {"panda_hand_tcp": judge.fk(q, "panda_hand_tcp")}
    wall = box("wall", (0.02, 2, 2), pose((0.2, 0, 0.5)))
    far = {"panda_hand_tcp": pose((3, 0, 0))}
    problems = [
        Problem(name="clear", robot="panda", solids=(), targets=targets, goal_q=q),
        Problem(name="walled", robot="panda", solids=(wall,), targets=targets, goal_q=q),
        Problem(name="far", robot="panda", solids=(), targets=far),
    ]
    method = Method("cloud", robot, [0.05])
    trials = run(problems[1:], method, judge)[0.05]
    row = row_of("set", "panda", "cloud", 0.05, trials)
    counted = [row[name] for name in ("solved", "wrong", "none", "missed", "ceiling")]
    assert counted == [0, 1, 1, 0, 0]
    assert "and wall" in trials[0]["fault"]
