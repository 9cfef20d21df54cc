"""Trees with several goals, as Pinocchio confirms."""

import numpy as np
import pytest

import pdoik
from random_urdf import RandomUrdf, random_urdf
from references import PinocchioRobot
from samples import random_configuration
from trees import H1_XML, LEFT, PATIENT, RIGHT, TIPS, by_name, confirm_limits, crouch, errors, near

SEEDS = range(15)


@pytest.fixture(scope="module")
def h1() -> pdoik.Robot:
    return pdoik.Robot.builtin("h1")


def tree_of(
    urdf: RandomUrdf, rng: np.random.Generator, tips: int = 2, base: str | None = None
) -> pdoik.Robot:
    links = [link for link in urdf.links[3:] if link != base]
    chosen = [str(link) for link in rng.choice(links, tips, replace=False)]
    return pdoik.Robot.from_urdf(urdf.xml, base_link=base, tip_link=chosen)


def test_h1_s_feet_and_hands_reach_their_goals_at_once(
    h1: pdoik.Robot, rng: np.random.Generator
) -> None:
    assert h1.tip_links == TIPS
    reference = PinocchioRobot.from_xml(H1_XML)
    solver = pdoik.Solver(h1, pdoik.Options(**PATIENT))
    for _ in range(20):
        wanted = near(h1, crouch(h1), rng, 0.3)
        goals = {tip: h1.fk(wanted, tip) for tip in TIPS}
        result = solver.solve(goals, q0=crouch(h1))
        confirm_limits(h1, result)
        assert result.success
        reference.set(by_name(h1, result.q))
        off = [errors(T, reference.pose("pelvis", tip)) for tip, T in goals.items()]
        assert result.position_error == pytest.approx(max(p for p, _ in off), abs=1e-11)
        assert result.rotation_error == pytest.approx(max(r for _, r in off), abs=1e-8)
        assert max(p for p, _ in off) <= 1e-5
        assert max(r for _, r in off) <= 1e-5 + 1e-9


def test_h1_s_hands_hold_one_box_wherever_it_is(h1: pdoik.Robot, rng: np.random.Generator) -> None:
    """The box's own place is loosely given; the grip is not."""
    reference = PinocchioRobot.from_xml(H1_XML)
    tight = pdoik.Options(position_tolerance=1e-6, rotation_tolerance=1e-6, **PATIENT)
    solver = pdoik.Solver(h1, tight)
    left, right = TIPS[2:]
    for _ in range(20):
        wanted = near(h1, crouch(h1), rng, 0.3)
        grip = np.linalg.inv(h1.fk(wanted, right)) @ h1.fk(wanted, left)
        slack = {"position_slack": [0.1] * 3, "rotation_slack": [0.3] * 3}
        place = near(h1, wanted, rng, 0.05)
        goals = {
            right: pdoik.Goal(h1.fk(place, right), **slack),
            left: pdoik.Goal(grip, relative_to=right),
        }
        result = solver.solve(goals, q0=crouch(h1))
        confirm_limits(h1, result)
        assert result.success
        reference.set(by_name(h1, result.q))
        hands = {tip: reference.pose("pelvis", tip) for tip in (left, right)}
        held = np.linalg.inv(hands[right]) @ hands[left]
        assert max(errors(grip, held)) < 1e-6 + 1e-9
        assert max(errors(h1.fk(place, right), hands[right], 0.1, 0.3)) < 1e-6 + 1e-9


@pytest.mark.parametrize(
    ("goals", "said"),
    [
        ({TIPS[2]: pdoik.Goal(np.eye(4), relative_to=TIPS[2])}, "relative to itself"),
        (
            {TIPS[2]: pdoik.Goal(np.eye(4), relative_to="hand")},
            "relative to 'hand', which is no tip",
        ),
    ],
)
def test_a_goal_relative_to_nothing_is_refused(
    h1: pdoik.Robot, goals: dict[str, pdoik.Goal], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        pdoik.Solver(h1).solve(goals)


def solved_trees(urdf: RandomUrdf, robot: pdoik.Robot, rng: np.random.Generator) -> int:
    reference = PinocchioRobot.from_xml(urdf.xml)
    solver = pdoik.Solver(robot, pdoik.Options(goal="position", **PATIENT))
    solved = 0
    for _ in range(3):
        wanted = random_configuration(robot, rng)
        goals = {tip: robot.fk(wanted, tip)[:3, 3] for tip in robot.tip_links}
        result = solver.solve(goals)
        confirm_limits(robot, result)
        assert result.status != "out_of_reach"
        reference.set(urdf.positions(by_name(robot, result.q)))
        off = [
            np.linalg.norm(reference.pose(robot.base_link, tip)[:3, 3] - goal)
            for tip, goal in goals.items()
        ]
        assert result.position_error == pytest.approx(max(off), abs=1e-11)
        assert result.success == (max(off) <= 1e-5)
        solved += result.success
    return solved


@pytest.mark.parametrize("seed", SEEDS)
def test_random_trees_reach_several_goals_from_any_base_as_pinocchio_confirms(
    seed: int, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=14, types=("revolute", "continuous", "prismatic"))
    base = None if seed % 2 == 0 else str(rng.choice(urdf.links))
    assert solved_trees(urdf, tree_of(urdf, rng, 2 + seed % 2, base), rng) >= 2


@pytest.mark.parametrize("seed", SEEDS)
def test_mimic_joints_are_honoured_where_a_tree_reaches_several_goals(
    seed: int, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=12, types=("revolute", "prismatic"), mimics=3)
    assert urdf.mimics
    assert solved_trees(urdf, tree_of(urdf, rng), rng) >= 1


def test_bare_targets_and_goals_may_stand_side_by_side_and_the_rest_is_free(
    h1: pdoik.Robot, rng: np.random.Generator
) -> None:
    solver = pdoik.Solver(h1, pdoik.Options(**PATIENT))
    wanted = near(h1, crouch(h1), rng, 0.3)
    T = {tip: h1.fk(wanted, tip) for tip in TIPS}
    mixed = {
        LEFT: T[LEFT],
        RIGHT: pdoik.Goal(T[RIGHT], type="axis", axis="z"),
        TIPS[2]: pdoik.Goal(T[TIPS[2]][:3, 3], type="position"),
    }
    result = solver.solve(mixed, q0=crouch(h1))
    assert result.success
    assert max(errors(T[LEFT], h1.fk(result.q, LEFT))) < 1.1e-5
    p, _ = errors(T[RIGHT], h1.fk(result.q, RIGHT))
    assert p < 1.1e-5
    assert np.arccos(min(T[RIGHT][:3, 2] @ h1.fk(result.q, RIGHT)[:3, 2], 1.0)) < 1.1e-5
    assert np.linalg.norm(T[TIPS[2]][:3, 3] - h1.fk(result.q, TIPS[2])[:3, 3]) < 1.1e-5


def test_a_batch_of_goals_by_tip_is_what_single_solves_give(
    h1: pdoik.Robot, rng: np.random.Generator
) -> None:
    solver = pdoik.Solver(h1, pdoik.Options(**PATIENT))
    wanted = [near(h1, crouch(h1), rng, 0.3) for _ in range(6)]
    goals = {tip: np.stack([h1.fk(q, tip) for q in wanted]) for tip in (LEFT, RIGHT)}
    batch = solver.solve_batch(goals, q0=crouch(h1), threads=2)
    assert len(batch) == 6
    for i in range(6):
        alone = solver.solve({tip: T[i] for tip, T in goals.items()}, q0=crouch(h1))
        np.testing.assert_array_equal(batch[i].q, alone.q)
    with pytest.raises(ValueError, match=rf"T_base_tip\['{RIGHT}'\] has 5 targets, expected 6"):
        solver.solve_batch({LEFT: goals[LEFT], RIGHT: goals[RIGHT][:5]})
