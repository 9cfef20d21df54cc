"""Balance is kept, by an independent hull of the feet."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import pdoik
from references import PinocchioRobot
from trees import (
    H1_XML,
    LEFT,
    PATIENT,
    RIGHT,
    SOLE,
    TIPS,
    by_name,
    confirm_limits,
    crouch,
    errors,
    near,
)


@pytest.fixture(scope="module")
def h1() -> pdoik.Robot:
    return pdoik.Robot.builtin("h1")


def beyond_polygon(corners: np.ndarray, point: np.ndarray) -> float:
    """By how much a point in the plane is beyond the convex hull's farthest edge."""
    return float((ConvexHull(corners).equations @ [*point, 1.0]).max())


@pytest.fixture(scope="module")
def standing() -> pdoik.Robot:
    """The H1 on its left foot."""
    return pdoik.Robot.builtin("h1", base_link=LEFT, tip_link=[RIGHT, *TIPS[2:]])


@pytest.mark.parametrize("margin", [0.0, 0.02])
def test_balanced_answers_have_their_mass_over_the_feet_by_an_independent_hull(
    standing: pdoik.Robot, margin: float, rng: np.random.Generator
) -> None:
    reference = PinocchioRobot.floating(H1_XML)
    balance = pdoik.Balance(contacts={LEFT: SOLE, RIGHT: SOLE}, support_margin=margin)
    balanced = pdoik.Solver(standing, pdoik.Options(balance=balance, **PATIENT))
    careless = pdoik.Solver(standing, pdoik.Options(**PATIENT))
    gaps = {balanced: [], careless: []}
    for _ in range(20):
        goal = standing.fk(crouch(standing), RIGHT)
        goal[0, 3] += rng.uniform(-0.2, 0.2)
        q0 = near(standing, crouch(standing), rng, 0.3)
        for solver, found in gaps.items():
            result = solver.solve({RIGHT: goal}, q0=q0)
            assert result.success
            confirm_limits(standing, result)
            reference.set(by_name(standing, result.q))
            T = reference.pose(LEFT, RIGHT)
            assert max(errors(goal, T)) < 1.1e-5
            corners = np.vstack([SOLE, SOLE @ T[:3, :3].T + T[:3, 3]])
            com = reference.center_of_mass(LEFT)
            found.append(beyond_polygon(corners[:, :2], com[:2]))
            if solver is balanced:
                np.testing.assert_allclose(result.center_of_mass, com, rtol=0, atol=1e-12)
                assert result.balance_violation <= 1e-6
    assert max(gaps[balanced]) <= -margin + 1.1e-6
    assert max(gaps[careless]) > 0.0  # so it does matter


def test_a_box_for_the_centre_of_mass_is_kept(
    standing: pdoik.Robot, rng: np.random.Generator
) -> None:
    reference = PinocchioRobot.floating(H1_XML)
    goal = {RIGHT: standing.fk(crouch(standing), RIGHT)}
    for _ in range(15):
        centre = standing.center_of_mass(crouch(standing)) + rng.uniform(-0.02, 0.02, 3)
        box = centre - 0.005, centre + 0.005
        balance = pdoik.Balance(com_lower=box[0], com_upper=box[1])
        solver = pdoik.Solver(standing, pdoik.Options(balance=balance, **PATIENT))
        result = solver.solve(goal, q0=crouch(standing))
        assert result.success
        reference.set(by_name(standing, result.q))
        com = reference.center_of_mass(LEFT)
        assert (com >= box[0] - 1.1e-6).all()
        assert (com <= box[1] + 1.1e-6).all()


def test_a_box_that_no_posture_meets_is_a_status_and_is_named(h1: pdoik.Robot) -> None:
    balance = pdoik.Balance(com_lower=(5.0, -1, -1))
    solver = pdoik.Solver(h1, pdoik.Options(balance=balance, max_time=60, max_restarts=3))
    result = solver.solve({LEFT: h1.fk(crouch(h1), LEFT)}, q0=crouch(h1))
    assert not result.success
    assert result.status == "exhausted"
    assert result.worst_constraint == "lower x of the centre of mass"
    assert result.worst_violation > 3.0


@pytest.mark.parametrize("beside", [0.05, 1.0])
def test_a_support_that_is_but_a_line_does_not_hold_up_what_is_beyond_its_ends(
    beside: float,
) -> None:
    robot = pdoik.Robot.builtin("h1", base_link=LEFT, tip_link=RIGHT)
    q = np.zeros(robot.dof)
    x, y, _ = robot.center_of_mass(q)
    line = [(x + beside, y, 0.0), (x + beside + 0.1, y, 0.0), (x + beside + 0.3, y, 0.0)]
    options = pdoik.Options(balance=pdoik.Balance(contacts={LEFT: line}), **PATIENT)
    result = pdoik.Solver(robot, options).judge(robot.fk(q), q)
    assert not result.success
    assert result.balance_violation == pytest.approx(beside, abs=1e-9)
    over = pdoik.Balance(contacts={LEFT: [(x - 0.1, y, 0.0), (x, y, 0.0), (x + 0.1, y, 0.0)]})
    assert pdoik.Solver(robot, pdoik.Options(balance=over)).judge(robot.fk(q), q).success


def test_a_success_is_called_solved_also_where_the_budget_ends_first() -> None:
    robot = pdoik.Robot.builtin("panda")
    q = robot.mid_configuration()
    low = (-9.0, -9.0, robot.center_of_mass(q)[2] + 0.01)
    common = {"clearance_tolerance": 0.05, "balance": pdoik.Balance(com_lower=low)}
    for budget in (
        {"max_time": 1e-9},
        {
            "max_restarts": 0,
            "levenberg_marquardt": pdoik.LevenbergMarquardtOptions(max_iterations=0),
        },
    ):
        result = pdoik.Solver(robot, pdoik.Options(**common, **budget)).solve(robot.fk(q), q0=q)
        assert result.success == (result.status == "solved")
