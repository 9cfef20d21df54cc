"""Forward kinematics and Jacobians are Pinocchio's, on shipped robots and on random trees."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pdoik
from random_urdf import RandomUrdf, random_urdf
from references import PinocchioRobot
from samples import random_configuration

SEEDS = range(25)


def agree(robot: pdoik.Robot, reference: PinocchioRobot, urdf: RandomUrdf, q: np.ndarray) -> None:
    """All links' poses and Jacobians at q are Pinocchio's, relative to the robot's base link."""
    reference.set(urdf.positions(dict(zip(robot.joint_names, q.tolist(), strict=True))))
    for link in robot.link_names:
        expected = reference.pose(robot.base_link, link)
        np.testing.assert_allclose(robot.fk(q, link), expected, rtol=0, atol=1e-12)
        columns = reference.jacobian(robot.base_link, link)
        J = np.stack([columns[name] for name in robot.joint_names], axis=1)  # (6, n)
        for follower, mimic in urdf.mimics.items():
            J[:, robot.joint_names.index(mimic.of)] += mimic.multiplier * columns[follower]
        np.testing.assert_allclose(robot.jacobian(q, link), J, rtol=0, atol=1e-12)


def test_shipped_robots_move_as_in_pinocchio(
    robot: pdoik.Robot, pinocchio: PinocchioRobot, rng: np.random.Generator
) -> None:
    assert robot.joint_names == pinocchio.joint_names
    np.testing.assert_array_equal(robot.lower, pinocchio.model.lowerPositionLimit)
    np.testing.assert_array_equal(robot.upper, pinocchio.model.upperPositionLimit)
    np.testing.assert_array_equal(robot.velocity, pinocchio.model.velocityLimit)
    urdf = RandomUrdf(xml="", links=robot.link_names)
    for q in [robot.mid_configuration(), robot.lower, robot.upper, np.zeros(robot.dof)]:
        agree(robot, pinocchio, urdf, q)
    for _ in range(20):
        agree(robot, pinocchio, urdf, random_configuration(robot, rng))


@pytest.mark.parametrize("seed", SEEDS)
def test_random_trees_move_as_in_pinocchio(seed: int, rng: np.random.Generator) -> None:
    urdf = random_urdf(rng, links=int(rng.integers(2, 16)))
    robot = pdoik.Robot.from_urdf(urdf.xml)
    reference = PinocchioRobot.from_xml(urdf.xml)
    assert robot.joint_names == reference.joint_names
    assert sorted(robot.link_names) == sorted(urdf.links)
    for _ in range(3):
        agree(robot, reference, urdf, random_configuration(robot, rng))


@pytest.mark.parametrize("seed", SEEDS)
def test_any_link_may_be_the_base(seed: int, rng: np.random.Generator) -> None:
    urdf = random_urdf(rng)
    reference = PinocchioRobot.from_xml(urdf.xml)
    for base in urdf.links:
        robot = pdoik.Robot.from_urdf(urdf.xml, base_link=base)
        assert robot.base_link == base
        assert sorted(robot.joint_names) == sorted(reference.joint_names)
        agree(robot, reference, urdf, random_configuration(robot, rng))


@pytest.mark.parametrize("seed", SEEDS)
def test_mimic_joints_follow_their_leader_from_any_base(
    seed: int, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=10, types=("revolute", "prismatic"), mimics=3)
    assert urdf.mimics
    reference = PinocchioRobot.from_xml(urdf.xml)
    for base in urdf.links:
        try:
            robot = pdoik.Robot.from_urdf(urdf.xml, base_link=base)
        except pdoik.LoadError as error:
            assert "no position satisfies the limits of both" in str(error)  # noqa: PT017
            return
        followers = set(reference.joint_names) - set(robot.joint_names)
        assert followers == set(urdf.mimics)
        agree(robot, reference, urdf, random_configuration(robot, rng))


@pytest.mark.parametrize("seed", range(10))
def test_limits_of_followers_hold_wherever_the_leader_may_go(
    seed: int, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=8, types=("revolute",), mimics=2)
    reference = PinocchioRobot.from_xml(urdf.xml)
    robot = pdoik.Robot.from_urdf(urdf.xml)
    model = reference.model
    for q in (robot.lower, robot.upper):
        positions = urdf.positions(dict(zip(robot.joint_names, q.tolist(), strict=True)))
        for name, value in positions.items():
            i = model.joints[model.getJointId(name)].idx_q
            assert (
                model.lowerPositionLimit[i] - 1e-12 <= value <= model.upperPositionLimit[i] + 1e-12
            )


@pytest.mark.parametrize("seed", SEEDS)
def test_the_jacobian_is_the_derivative_of_fk(seed: int, rng: np.random.Generator) -> None:
    urdf = random_urdf(rng, links=8, mimics=2)
    try:
        robot = pdoik.Robot.from_urdf(urdf.xml, base_link=urdf.links[4])
    except pdoik.LoadError:
        pytest.skip("the mimic joints' limits exclude each other")
    q = random_configuration(robot, rng)
    h = 1e-6
    for link in robot.link_names:
        J = robot.jacobian(q, link)
        R = robot.fk(q, link)[:3, :3]
        for i in range(robot.dof):
            step = h * np.eye(robot.dof)[i]
            dT = (robot.fk(q + step, link) - robot.fk(q - step, link)) / (2 * h)
            spin = dT[:3, :3] @ R.T
            np.testing.assert_allclose(J[:3, i], dT[:3, 3], rtol=0, atol=1e-8)
            np.testing.assert_allclose(
                J[3:, i], [spin[2, 1], spin[0, 2], spin[1, 0]], rtol=0, atol=1e-8
            )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_frames_stay_rigid_however_near_an_axis_lies_to_z(sign: float) -> None:
    for tilt in (0.0, *np.logspace(-9, 0, 28)):
        axis = (0.6 * tilt, 0.8 * tilt, sign)
        robot = pdoik.Robot.from_urdf(
            '<robot name="r"><link name="a"/><link name="b"/>'
            '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>'
            f'<axis xyz="{" ".join(map(str, axis))}"/>'
            '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>'
        )
        for angle in (0.0, 1.0):
            turn = Rotation.from_rotvec(angle * np.array(axis) / np.linalg.norm(axis)).as_matrix()
            np.testing.assert_allclose(robot.fk([angle])[:3, :3], turn, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", range(10))
def test_dh_rows_are_the_paper_s_matrices(seed: int, rng: np.random.Generator) -> None:
    count = int(rng.integers(1, 8))
    table = [
        {
            "alpha": rng.uniform(-np.pi, np.pi),
            "a": rng.uniform(-0.5, 0.5),
            "d": rng.uniform(-0.5, 0.5),
            "theta_offset": rng.uniform(-np.pi, np.pi),
            "prismatic": bool(rng.random() < 0.3),
        }
        for _ in range(count)
    ]
    rows = [pdoik.DhRow(**row, lower=-1.0, upper=2.0) for row in table]
    T_last_tool = np.eye(4)
    T_last_tool[:3, 3] = rng.uniform(-0.2, 0.2, 3)
    robot = pdoik.Robot.from_dh(rows, T_last_tool)
    q = rng.uniform(-1.0, 2.0, count)
    T = np.eye(4)
    for row, position in zip(table, q, strict=True):
        theta = row["theta_offset"] + (0.0 if row["prismatic"] else position)
        d = row["d"] + (position if row["prismatic"] else 0.0)
        ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(row["alpha"]), np.sin(row["alpha"])
        T = T @ np.array(  # Eq. DH_matrix, entry (2, 4) corrected to -d sin(alpha)
            [
                [ct, -st, 0, row["a"]],
                [st * ca, ct * ca, -sa, -d * sa],
                [st * sa, ct * sa, ca, d * ca],
                [0, 0, 0, 1],
            ]
        )
    np.testing.assert_allclose(robot.fk(q), T @ T_last_tool, rtol=0, atol=1e-12)
