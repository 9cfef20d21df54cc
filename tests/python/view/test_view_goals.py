"""pdoik view's richer goals: alternatives, cones, points to look at, all solutions."""

from __future__ import annotations

import numpy as np
import pytest

import pdoik
from pdoik.view import Session, Shown
from pdoik.view.goals import TipGoal, choice_of, choice_text, count_requests, request_of, requests
from pdoik.view.status import Meter, status_html

TIP = "panda_link8"
REACHED = [0.3, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8]
PATIENT = pdoik.Options(max_time=5.0)


@pytest.fixture
def session() -> Session:
    """A Panda that has been shown once."""
    session = Session(pdoik.Robot.builtin("panda"), PATIENT, q0=np.array(REACHED))
    assert session.solve_once() is not None
    return session


def solved(session: Session) -> Shown:
    shown = session.solve_once()
    assert shown is not None
    return shown


def shifted(T: np.ndarray, *xyz: float) -> np.ndarray:
    moved = T.copy()
    moved[:3, 3] += xyz
    return moved


def tilt_of(session: Session, T: np.ndarray, q: np.ndarray) -> float:
    """The angle between the tip's z axis and that of T [rad]."""
    z, wanted = session.robot.fk(q)[:3, 2], T[:3, 2]
    return float(np.arctan2(np.linalg.norm(np.cross(z, wanted)), z @ wanted))


def test_of_several_targets_the_one_that_is_met_is_kept_until_it_cannot_be(
    session: Session,
) -> None:
    T = session.targets[TIP]
    session.add_target(TIP, shifted(T, 0.0, -0.2, 0.1))
    shown = solved(session)
    assert (shown.choice, shown.met[TIP]) == ("goal 1 of 2", 0)
    session.set_target(TIP, shifted(T, 0.02, 0.0, 0.0))
    assert solved(session).met[TIP] == 0

    session.set_target(TIP, shifted(T, 3.0, 0.0, 0.0))
    shown = solved(session)
    assert shown.result.success
    assert shown.choice == "goal 2 of 2"
    assert "goal 2 of 2" in status_html(shown, Meter())
    np.testing.assert_allclose(
        session.robot.fk(shown.q), session.tip_goals[TIP].targets[1], atol=2e-5
    )
    session.set_target(TIP, T)  # could be met again, but the other one still is
    assert solved(session).met[TIP] == 1
    session.set_target(TIP, shifted(T, 0.0, -0.2, 0.15), 1)
    shown = solved(session)
    np.testing.assert_allclose(session.robot.fk(shown.q)[2, 3], T[2, 3] + 0.15, atol=2e-5)

    session.drop_target(TIP)
    shown = solved(session)
    assert (shown.choice, shown.met[TIP]) == ("", 0)
    np.testing.assert_allclose(session.robot.fk(shown.q), T, atol=2e-5)


def test_targets_that_make_no_sense_are_refused(session: Session) -> None:
    with pytest.raises(ValueError, match="there is no 2"):
        session.set_target(TIP, np.eye(4), 1)
    with pytest.raises(ValueError, match="no tip"):
        session.add_target("hand", np.eye(4))
    for _ in range(63):
        session.add_target(TIP, np.eye(4))
    with pytest.raises(ValueError, match="more than 64"):
        session.add_target(TIP, np.eye(4))


def test_each_choice_of_targets_is_one_request_and_is_found_again() -> None:
    poses = [shifted(np.eye(4), x, 0.0, 0.0) for x in range(3)]
    goals = {
        "left": TipGoal(kind="pose", targets=tuple(poses)),
        "idle": TipGoal(kind="free", targets=(np.eye(4),)),
        "right": TipGoal(kind="position", targets=tuple(poses[:2])),
    }
    asked = requests(goals, "right")
    assert len(asked) == count_requests(goals) == 6
    for number, request in enumerate(asked):
        choice = choice_of(goals, number)
        assert request_of(goals, choice) == number
        assert set(request) == {"left", "right"}
        assert all(goal.T_base_tip[0, 3] == choice[tip] for tip, goal in request.items())
    assert choice_text(goals, choice_of(goals, 5)) == "goal 3 of 3 (left), goal 2 of 2 (right)"


@pytest.mark.parametrize("cone", [0.0, 0.2])
def test_an_axis_points_off_as_far_as_its_cone_lets_it(session: Session, cone: float) -> None:
    T = session.targets[TIP]
    turned = T.copy()
    c, s = np.cos(0.5), np.sin(0.5)
    turned[:3, :3] = T[:3, :3] @ [[1, 0, 0], [0, c, -s], [0, s, c]]
    session.set_goal(TIP, "axis")
    session.set_cone(TIP, cone)
    session.set_target(TIP, turned)
    shown = solved(session)
    assert shown.result.success
    assert tilt_of(session, turned, shown.q) == pytest.approx(cone, abs=5e-5)


def test_a_tip_looks_at_a_point_wherever_it_is_itself(session: Session) -> None:
    session.set_goal(TIP, "look_at")
    ahead = session.targets[TIP]
    np.testing.assert_allclose(solved(session).q, REACHED, atol=1e-9)  # it looks there already
    point = shifted(ahead, 0.1, 0.15, 0.0)
    session.set_target(TIP, point)
    shown = solved(session)
    assert shown.result.success
    T = session.robot.fk(shown.q)
    way = point[:3, 3] - T[:3, 3]
    np.testing.assert_allclose(T[:3, 2], way / np.linalg.norm(way), atol=5e-5)
    session.set_goal(TIP, "pose")
    np.testing.assert_allclose(session.targets[TIP], T, atol=1e-12)


def test_with_the_position_first_the_orientation_is_as_near_as_can_be(session: Session) -> None:
    T = shifted(session.targets[TIP], 0.15, 0.1, 0.2)
    T[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # back towards the base from far out
    session.set_target(TIP, T)
    assert not solved(session).met_to_tolerance
    session.set_options(priority="position")
    shown = solved(session)
    assert (shown.result.status, shown.met_to_tolerance) == ("nearest", True)
    np.testing.assert_allclose(session.robot.fk(shown.q)[:3, 3], T[:3, 3], atol=2e-5)
    text = status_html(shown, Meter())
    assert "nearest" in text
    assert shown.found.message in text


def test_all_solutions_of_a_ur10_meet_the_target_and_leave_it_where_it_is() -> None:
    pytest.importorskip("viser", reason="pip install 'pdoik[view]'")
    from pdoik.view.panels.solutions_panel import solutions_text

    robot = pdoik.Robot.builtin("ur10")
    session = Session(robot, PATIENT, q0=np.array([0.3, -1.2, 1.4, -1.0, -1.3, 0.2]))
    solved(session)
    (tip,) = robot.tip_links
    T = session.targets[tip]
    all_solutions = session.find_all(32)
    found = all_solutions.found
    assert found.complete
    assert len(found) > 1
    distances = [np.linalg.norm(result.q - session.q) for result in found]
    assert distances == sorted(distances)
    text = solutions_text(all_solutions, 1)
    assert text.startswith(f"{len(found)} solutions, these are all. No. 2: ")
    assert f"{found.turns[1]} ways" in text
    for result in found:
        session.show_solution(result.q)
        shown = solved(session)
        assert shown.origin == "solution"
        assert shown.result.success
        np.testing.assert_allclose(robot.fk(shown.q), T, atol=2e-5)
    np.testing.assert_array_equal(session.targets[tip], T)
    assert "perhaps not all" in solutions_text(
        Session(pdoik.Robot.builtin("panda"), PATIENT, q0=np.array(REACHED)).find_all(4), 0
    )


def test_solutions_keep_off_what_is_in_the_way(session: Session) -> None:
    elbow = session.robot.fk(REACHED, "panda_link4")[:3, 3]
    session.set_shapes([pdoik.Shape.sphere("ball", elbow + np.array([0.0, 0.1, 0.0]), 0.08)])
    found = session.find_all(16).found
    assert len(found) == 16
    assert min(result.clearance for result in found) >= 0
