"""Slack, weights, postures, the nearest answer, and steps of limited length."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pdoik
from conftest import ROBOTS
from references import PinocchioRobot
from samples import random_configuration
from trees import PATIENT, TIPS, by_name, confirm_limits, errors, near

SEEDS = range(15)


@pytest.mark.parametrize("seed", SEEDS)
def test_slack_frees_each_axis_of_the_target_by_as_much_and_no_more(
    seed: int, robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    T = robot.fk(robot.mid_configuration() + rng.uniform(-0.5, 0.5, robot.dof))
    position_slack, rotation_slack = rng.uniform(0, 0.2, 3), rng.uniform(0, 0.5, 3)
    position_slack[seed % 3] = rotation_slack[(seed + 1) % 3] = 0.0
    reference = PinocchioRobot.from_xml((ROBOTS / f"{robot.name}.urdf").read_text())
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    goal = pdoik.Goal(T, position_slack=position_slack, rotation_slack=rotation_slack)
    tip = robot.tip_links[0]

    def confirmed(result: pdoik.Result) -> np.ndarray:
        assert result.success
        confirm_limits(robot, result)
        reference.set(by_name(robot, result.q))
        reached = reference.pose(robot.base_link, tip)
        p, r = errors(T, reached, position_slack, rotation_slack)
        assert result.position_error == pytest.approx(p, abs=1e-11)
        assert result.rotation_error == pytest.approx(r, abs=1e-8)
        assert p <= 1e-5
        assert r <= 1e-5 + 1e-9
        return reached

    # Almost at the corner of what is allowed the answer need not move; beyond it, back to it.
    for share in (0.99, 1.3):
        off = np.eye(4)
        off[:3, 3] = share * position_slack * rng.choice([-1, 1], 3)
        turn = share * rotation_slack * rng.choice([-1, 1], 3)
        off[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
        start = solver.solve(T @ off)
        if not start.success:
            continue
        reached = confirmed(solver.solve(goal, q0=start.q))
        if share < 1:
            np.testing.assert_allclose(reached, T @ off, rtol=0, atol=3e-5)
        else:
            assert max(errors(T, reached)) > 1e-3


def test_an_axis_freed_by_pi_may_turn_right_round(robot: pdoik.Robot) -> None:
    q = robot.mid_configuration() + 0.3
    T = robot.fk(q)
    solver = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    for angle in np.linspace(-3.0, 3.0, 7):
        turned = T.copy()
        turned[:3, :3] = T[:3, :3] @ Rotation.from_rotvec([0, 0, angle]).as_matrix()
        result = solver.solve(pdoik.Goal(turned, rotation_slack=[0, 0, np.pi]), q0=q)
        assert result.success
        np.testing.assert_allclose(result.q, q, rtol=0, atol=1e-9)


TWO_TIPS = """<robot name="slide"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="j" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-5" upper="5" effort="1" velocity="1"/></joint>
<joint name="k" type="fixed"><parent link="b"/><child link="c"/></joint>
<joint name="l" type="fixed"><parent link="b"/><child link="d"/></joint></robot>"""


@pytest.mark.parametrize("weight", [0.1, 1.0, 3.0, 1000.0])
def test_goals_that_cannot_all_be_met_share_by_their_weights(weight: float) -> None:
    robot = pdoik.Robot.from_urdf(TWO_TIPS)
    assert robot.tip_links == ["c", "d"]
    solver = pdoik.Solver(robot, pdoik.Options(goal="position", **PATIENT))
    goals = {"c": [0.0, 0, 0], "d": pdoik.Goal([1.0, 0, 0], type="position", weight=weight)}
    result = solver.solve(goals)
    assert result.status == "exhausted"
    assert result.q[0] == pytest.approx(weight / (1 + weight), abs=1e-6)
    assert result.worst_constraint == f"position of {'c' if weight > 1 else 'd'}" or weight == 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_posture_is_approached_and_never_at_the_goal_s_expense(
    seed: int, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin(("panda", "iiwa14")[seed % 2])
    solver = pdoik.Solver(robot, pdoik.Options(goal="position", **PATIENT))
    posture = random_configuration(robot, rng)
    target = robot.fk(random_configuration(robot, rng))
    plain = solver.solve(target)
    drawn = solver.solve(target, posture=posture)
    assert plain.success
    assert drawn.success
    assert np.linalg.norm(robot.fk(drawn.q)[:3, 3] - target[:3, 3]) <= 1e-5 + 1e-11
    assert np.linalg.norm(drawn.q - posture) <= np.linalg.norm(plain.q - posture) + 1e-9
    # A posture that meets the goal is the answer.
    q0 = np.clip(posture + rng.uniform(-0.2, 0.2, robot.dof), robot.lower, robot.upper)
    at_goal = solver.solve(robot.fk(posture), q0=q0, posture=posture)
    np.testing.assert_allclose(at_goal.q, posture, rtol=0, atol=2e-2)


def test_joint_weights_say_which_joints_stay(rng: np.random.Generator) -> None:
    robot = pdoik.Robot.builtin("panda")
    moved = np.zeros((2, 7))
    for _ in range(10):
        posture = np.clip(
            robot.mid_configuration() + rng.uniform(-0.3, 0.3, 7), robot.lower, robot.upper
        )
        target = robot.fk(near(robot, posture, rng, 0.1))
        for k, weights in enumerate(([100, 1, 1, 1, 1, 1, 1], [1, 1, 1, 100, 1, 1, 1])):
            options = pdoik.Options(goal="position", joint_weights=weights, **PATIENT)
            result = pdoik.Solver(robot, options).solve(target, q0=posture, posture=posture)
            assert result.success
            moved[k] += np.abs(result.q - posture)
    assert moved[0, 0] < 0.2 * moved[1, 0]
    assert moved[1, 3] < 0.2 * moved[0, 3]


def test_the_nearest_answer_is_no_farther_than_the_first(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    first = pdoik.Solver(robot, pdoik.Options(**PATIENT))
    options = pdoik.Options(prefer="nearest", **PATIENT)
    nearest = pdoik.Solver(robot, options)
    sums = np.zeros(2)
    for _ in range(10):
        q0, posture, q = (random_configuration(robot, rng) for _ in range(3))
        T = robot.fk(q)
        for k, solver in enumerate((first, nearest)):
            result = solver.solve(T, q0=q0)
            assert result.success
            sums[k] += np.linalg.norm(result.q - q0)
        to_posture = nearest.solve(T, q0=q0, posture=posture)
        assert to_posture.success
        assert errors(T, robot.fk(to_posture.q))[0] <= 1e-5 + 1e-11
    assert sums[1] < sums[0]


@pytest.mark.parametrize("seed", SEEDS)
def test_no_step_is_longer_than_allowed_whatever_the_target(
    seed: int, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("h1")
    solver = pdoik.Solver(robot, pdoik.Options(**{**PATIENT, "max_restarts": 3}))
    q0 = random_configuration(robot, rng)
    step = rng.uniform(0, 0.1, robot.dof)
    step[seed % robot.dof] = 0.0
    far = random_configuration(robot, rng)
    result = solver.solve({tip: robot.fk(far, tip) for tip in TIPS}, q0=q0, max_step=step)
    assert (np.abs(result.q - q0) <= step + 1e-15).all()
    assert result.q[seed % robot.dof] == q0[seed % robot.dof]
    confirm_limits(robot, result)
    within = np.clip(q0 + rng.uniform(-0.7, 0.7) * step, robot.lower, robot.upper)
    result = solver.solve({tip: robot.fk(within, tip) for tip in TIPS}, q0=q0, max_step=step)
    assert result.success
    assert (np.abs(result.q - q0) <= step + 1e-15).all()
