"""Which joint pdoik view names as the one that is nearest to a limit."""

from __future__ import annotations

import numpy as np
import pytest

import pdoik
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
