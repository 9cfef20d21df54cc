"""A robot that stands in the world, and one that floats in it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pdoik
from references import PinocchioRobot
from samples import random_configuration
from trees import H1_XML, LEFT, PATIENT, RIGHT, TIPS, by_name, confirm_limits, crouch, errors, near


def some_pose(rng: np.random.Generator) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    T[:3, 3] = rng.uniform(-1, 1, 3)
    return T


@pytest.mark.parametrize("base", ["pelvis", LEFT])
def test_a_robot_that_stands_in_the_world_speaks_its_frame(
    base: str, rng: np.random.Generator
) -> None:
    T = some_pose(rng)
    plain = pdoik.Robot.builtin("h1", base_link=base, tip_link=RIGHT)
    placed = pdoik.Robot.builtin("h1", base_link=base, tip_link=RIGHT, T_world_base=T)
    assert placed.base_link == "world"
    assert placed.joint_names == plain.joint_names
    assert placed.total_mass == pytest.approx(plain.total_mass)
    reference = PinocchioRobot.floating(H1_XML)
    for _ in range(5):
        q = random_configuration(plain, rng)
        reference.set(by_name(plain, q))
        pose = T @ reference.pose(base, RIGHT)
        np.testing.assert_allclose(placed.fk(q), pose, rtol=0, atol=1e-12)
        com = T[:3, :3] @ reference.center_of_mass(base) + T[:3, 3]
        np.testing.assert_allclose(placed.center_of_mass(q), com, rtol=0, atol=1e-12)
    result = pdoik.Solver(placed, pdoik.Options(**PATIENT)).solve(placed.fk(q))
    assert result.success
    reference.set(by_name(plain, result.q))
    assert max(errors(placed.fk(q), T @ reference.pose(base, RIGHT))) < 1.1e-5


@pytest.mark.parametrize("base", ["pelvis", LEFT, None])
def test_a_floating_base_goes_where_pinocchio_s_would(
    base: str | None, rng: np.random.Generator
) -> None:
    bounds = (np.array([-1.0, -1, -1, -3, -1, -1]), np.array([1.0, 1, 1, 3, 1, 1]))
    robot = pdoik.Robot.builtin("h1", base_link=base, tip_link=TIPS, floating_base=bounds)
    names = ["base_x", "base_y", "base_z", "base_yaw", "base_pitch", "base_roll"]
    assert robot.joint_names[:6] == names
    np.testing.assert_array_equal(robot.lower[:6], bounds[0])
    np.testing.assert_array_equal(robot.upper[:6], bounds[1])
    reference, link = PinocchioRobot.floating(H1_XML), base or "pelvis"
    T = np.eye(4)
    for _ in range(5):
        q = random_configuration(robot, rng)
        T[:3, 3] = q[:3]
        T[:3, :3] = Rotation.from_euler("ZYX", q[3:6]).as_matrix()
        reference.set(dict(zip(robot.joint_names[6:], q[6:].tolist(), strict=True)))
        for tip in TIPS:
            pose = T @ reference.pose(link, tip)
            np.testing.assert_allclose(robot.fk(q, tip), pose, rtol=0, atol=1e-12)
        com = T[:3, :3] @ reference.center_of_mass(link) + T[:3, 3]
        np.testing.assert_allclose(robot.center_of_mass(q), com, rtol=0, atol=1e-12)
    q = near(robot, np.concatenate([np.zeros(6), crouch(robot)[6:]]), rng, 0.2)
    goals = {tip: robot.fk(q, tip) for tip in TIPS}
    result = pdoik.Solver(robot, pdoik.Options(**PATIENT)).solve(goals)
    assert result.success
    confirm_limits(robot, result)
    assert max(max(errors(goal, robot.fk(result.q, tip))) for tip, goal in goals.items()) < 1.1e-5
