"""Which joint pdoik view names as the one that is nearest to a limit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pdoik
from pdoik.view.drawing.limit_scene import joint_axis, moved_by
from pdoik.view.limits import limit_text, nearest_limit


def test_the_joint_with_the_least_share_of_its_range_left_is_named() -> None:
    robot = pdoik.Robot.builtin("panda")
    q = robot.mid_configuration()
    q[5] = robot.upper[5] - np.radians(2.0)
    limit = nearest_limit(robot, q)
    assert limit is not None
    assert (limit.joint, limit.side) == (5, "upper")
    assert 100 * limit.share == pytest.approx(0.9, abs=0.1)
    assert limit_text(limit, robot) == "panda_joint6, 2.0° to its upper limit (1 % of its range)"


def test_joints_without_limits_are_near_none() -> None:
    urdf = """<robot name="arm"><link name="base"/><link name="a"/><link name="b"/>
      <joint name="turn" type="continuous"><parent link="base"/><child link="a"/>
        <axis xyz="0 0 1"/></joint>
      {}</robot>"""
    slide = """<joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
      <axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>"""
    fixed = """<joint name="slide" type="fixed"><parent link="a"/><child link="b"/></joint>"""
    assert nearest_limit(pdoik.Robot.from_urdf(urdf.format(fixed)), np.array([1.0])) is None
    robot = pdoik.Robot.from_urdf(urdf.format(slide))
    limit = nearest_limit(robot, np.array([9.0, 0.05]))
    assert limit is not None
    assert limit_text(limit, robot) == "slide, 50.0 mm to its lower limit (10 % of its range)"


def test_the_axis_of_a_joint_is_what_its_link_turns_about(
    robot: pdoik.Robot, rng: np.random.Generator
) -> None:
    movers = moved_by(robot)
    q = rng.uniform(robot.lower, robot.upper)
    for joint in range(robot.dof):
        place, axis = joint_axis(robot, q, joint, movers)
        moved = q.copy()
        moved[joint] += 0.3
        for link in robot.link_names:
            T, after = robot.fk(q, link), robot.fk(moved, link)
            if joint not in movers[link]:
                np.testing.assert_allclose(after, T, atol=1e-12)
                continue
            turn = Rotation.from_rotvec(0.3 * axis).as_matrix()
            np.testing.assert_allclose(after[:3, :3], turn @ T[:3, :3], atol=1e-9)
            np.testing.assert_allclose(after[:3, 3], place + turn @ (T[:3, 3] - place), atol=1e-9)


def test_a_sliding_joint_has_its_direction_for_an_axis() -> None:
    robot = pdoik.Robot.from_urdf(
        """<robot name="slide"><link name="base"/><link name="cart"/>
        <joint name="x" type="prismatic"><parent link="base"/><child link="cart"/>
        <origin xyz="0 0 0.4" rpy="0 0 1.5708"/><axis xyz="1 0 0"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
    )
    place, axis = joint_axis(robot, np.array([0.2]), 0, moved_by(robot))
    np.testing.assert_allclose(axis, [0, 1, 0], atol=1e-4)
    np.testing.assert_allclose(place, [0, 0.2, 0.4], atol=1e-4)
