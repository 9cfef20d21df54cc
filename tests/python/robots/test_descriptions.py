"""Robots as people have them: MJCF by MuJoCo's own poses, xacro, packages, names, hulls kept."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import pdoik
from pdoik.descriptions import (  # inside: what is installed is replaced
    RobotDescription,
    installed,
    tree_of,
    urdf_joints,
)
from pdoik.errors import LoadError
from studies import JOINTS
from studies import MJCF as ARM_MJCF
from studies import URDF as ARM_URDF

MJCF = """
<mujoco model="strange">
  <compiler angle="radian" autolimits="true"/>
  <default><joint armature="0.01"/><geom density="800"/></default>
  <asset><mesh name="wedge" vertex="0 0 0  0.2 0 0  0 0.1 0  0 0 0.15"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="trunk" pos="0.1 -0.2 0.5" euler="0.3 0 0.2">
      <freejoint/>
      <geom type="box" size="0.1 0.05 0.02"/>
      <body name="upper" pos="0.1 0.02 0.03" quat="0.9 0.1 -0.3 0.2">
        <joint name="yaw" axis="0 0.2 1" pos="0.01 0.02 -0.03" range="-1.2 0.9"/>
        <joint name="pitch" axis="0 1 0" pos="-0.02 0 0.04" ref="0.4" range="-1 2"
               actuatorfrcrange="-7 7"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.02"/>
        <body name="slider" pos="0.3 0 0.1" euler="0 1.5707963267948966 0">
          <joint name="lift" type="slide" axis="1 0 1" ref="0.05" range="-0.1 0.2"/>
          <geom type="mesh" mesh="wedge"/>
          <body name="wheel" pos="0 0.1 0"><joint name="spin" axis="0 0 1"/>
            <geom type="cylinder" size="0.05 0.01"/></body>
          <body pos="0 -0.1 0"><joint name="follower" axis="0 0 1" range="-3 3"/>
            <geom type="sphere" size="0.03"/></body>
          <body name="fixed" pos="0 0 0.1" euler="0.1 0.2 0.3"/>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="follower" joint2="spin" polycoef="0.1 -0.5 0 0 0"/></equality>
  <actuator><motor joint="yaw" gear="2" forcerange="-3 3"/></actuator>
</mujoco>"""


@pytest.fixture
def strange(tmp_path: Path) -> Path:
    path = tmp_path / "strange.xml"
    path.write_text(MJCF)
    return path


def test_a_model_of_mujoco_moves_as_it_does_there(strange: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(strange))
    data = mujoco.MjData(model)
    tips = ["wheel", "body5", "fixed"]
    robot = pdoik.load_robot(strange, base_link="trunk", tip_link=tips)
    assert set(robot.joint_names) == {"yaw", "pitch", "lift", "spin"}
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = rng.uniform(-1.0, 1.0, robot.dof)
        named = dict(zip(robot.joint_names, q, strict=True))
        named["follower"] = 0.1 - 0.5 * named["spin"]
        for name, value in named.items():
            data.qpos[model.joint(name).qposadr[0]] = value
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        base = model.body("trunk").id
        turned = data.xmat[base].reshape(3, 3)
        for name, number in (("upper", 2), ("slider", 3), ("wheel", 4), ("body5", 5), ("fixed", 6)):
            pose = robot.fk(q, name)
            place = turned.T @ (data.xpos[number] - data.xpos[base])
            assert pose[:3, 3] == pytest.approx(place, abs=1e-9), name
            assert pose[:3, :3] == pytest.approx(
                turned.T @ data.xmat[number].reshape(3, 3), abs=1e-9
            )
        centre = turned.T @ (data.subtree_com[base] - data.xpos[base])
        assert robot.center_of_mass(q) == pytest.approx(centre, abs=1e-9)


def test_limits_are_those_that_the_model_has(strange: Path) -> None:
    pytest.importorskip("mujoco")
    robot = pdoik.load_robot(strange, base_link="trunk", tip_link=["wheel", "body5", "fixed"])
    at = {name: k for k, name in enumerate(robot.joint_names)}
    assert robot.lower[at["yaw"]] == -1.2
    assert robot.upper[at["lift"]] == 0.2
    assert robot.joint_types[at["spin"]] == "continuous"
    assert robot.effort[at["yaw"]] == 6.0  # by the actuator, through its gear
    assert robot.effort[at["pitch"]] == 7.0
    assert robot.velocity[at["yaw"]] >= 1e6


def test_what_a_urdf_cannot_say_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    path = tmp_path / "ball.xml"
    path.write_text(
        '<mujoco><worldbody><body name="a"><joint name="hip" type="ball"/>'
        '<geom size="0.1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(LoadError, match="joint 'hip' is a ball"):
        pdoik.load_robot(path)
    path.write_text("<mujoco><worldbody><body></worldbody></mujoco>")
    with pytest.raises(LoadError, match="MuJoCo cannot read it: "):
        pdoik.load_robot(path)


def test_a_urdf_that_mujoco_wrote_as_mjcf_is_the_same_robot(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    urdf = Path(__file__).parents[3] / "cpp" / "robots" / "iiwa14.urdf"
    path = tmp_path / "iiwa.xml"
    mujoco.mj_saveLastXML(str(path), mujoco.MjModel.from_xml_path(str(urdf)))
    first, back = pdoik.Robot.builtin("iiwa14"), pdoik.load_robot(path)
    assert back.joint_names == first.joint_names
    for seed in range(5):
        q = np.random.default_rng(seed).uniform(first.lower, first.upper)
        link = first.link_names[-2]
        assert back.fk(q, link) == pytest.approx(first.fk(q, link), abs=1e-6)


def test_geometry_is_where_mujoco_has_it(strange: Path, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    from pdoik.occupancy_fit import load_geometry

    text = pdoik.urdf_text(strange, meshes=tmp_path)
    links = {link.name: link.triangles for link in load_geometry(text)}
    model = mujoco.MjModel.from_xml_path(str(strange))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = model.body("slider").id
    (g,) = np.flatnonzero(model.geom_bodyid == body)
    vertices = data.geom_xpos[g] + model.mesh_vert @ data.geom_xmat[g].reshape(3, 3).T
    here = (vertices - data.xpos[body]) @ data.xmat[body].reshape(3, 3)
    assert links["slider"].reshape(-1, 3).min(axis=0) == pytest.approx(here.min(axis=0), abs=1e-6)
    assert links["slider"].reshape(-1, 3).max(axis=0) == pytest.approx(here.max(axis=0), abs=1e-6)
    assert np.abs(links["trunk"].reshape(-1, 3)).max(axis=0) == pytest.approx([0.1, 0.05, 0.02])
    along = links["upper"].reshape(-1, 3)
    assert along[:, 0].max() == pytest.approx(0.32, abs=0.003)  # the capsule's round end


XACRO = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="0.4"/>
  <xacro:include filename="$(find parts)/joint.xacro"/>
  <link name="base"/><link name="tool"/>
  <xacro:turning name="elbow" length="$(arg length)"/>
</robot>"""
PART = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="turning" params="name length">
    <joint name="${name}" type="revolute"><parent link="base"/><child link="tool"/>
      <origin xyz="${2 * length} 0 0"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  </xacro:macro>
</robot>"""


def test_xacro_is_expanded_with_its_arguments_and_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xacro")
    for folder in ("arm", "ws/share/parts"):
        (tmp_path / folder).mkdir(parents=True)
    file = tmp_path / "arm" / "arm.urdf.xacro"
    file.write_text(XACRO)
    (tmp_path / "ws" / "share" / "parts" / "joint.xacro").write_text(PART)
    with pytest.raises(LoadError, match="package 'parts' is nowhere"):
        pdoik.load_robot(file)
    told = pdoik.load_robot(
        file, arguments={"length": "0.5"}, packages={"parts": tmp_path / "ws/share/parts"}
    )
    assert told.fk([0.0])[0, 3] == pytest.approx(1.0)
    monkeypatch.setenv("PDOIK_PACKAGE_PATH", str(tmp_path / "ws" / "share"))
    assert pdoik.load_robot(file).fk([0.0])[0, 3] == pytest.approx(0.8)
    file.write_text(XACRO.replace("</robot>", "<xacro:nothing/></robot>"))
    with pytest.raises(LoadError, match="xacro: "):
        pdoik.load_robot(file)


def test_installed_descriptions_are_found_by_name() -> None:
    pytest.importorskip("pinocchio")
    if "ur5_robot" not in installed.names():
        pytest.skip("example-robot-data is not installed")
    assert pdoik.load_robot("panda").occupancy.spheroids  # the shipped one
    assert pdoik.load_robot("ur5_robot").joint_names == pdoik.load_robot("ur5").joint_names
    with pytest.raises(LoadError, match=r"no robot 'g1_29dof'.*nearest: g1_29dof_rev_1_0"):
        pdoik.load_robot("g1_29dof")
    assert pdoik.load_robot("go2", tip_link=["FL_foot", "RR_foot"]).dof == 12
    with pytest.raises(LoadError, match=r"no robot 'ur5_robott'.*nearest: ur5_robot"):
        pdoik.load_robot("ur5_robott")
    with pytest.raises(LoadError, match=r"no such file: nowhere\.urdf"):
        pdoik.load_robot("nowhere.urdf")


def test_hulls_are_fitted_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    path = tmp_path / "ball.xml"
    path.write_text(
        '<mujoco><worldbody><body name="arm"><joint name="turn"/>'
        '<geom pos="0.1 0 0" size="0.05"/></body></worldbody></mujoco>'
    )
    monkeypatch.setenv("PDOIK_CACHE", str(tmp_path / "cache"))
    first = pdoik.load_robot(path, hulls=True)
    (kept,) = (tmp_path / "cache" / "hulls").iterdir()
    os.utime(kept, (0, 0))
    again = pdoik.load_robot(path, hulls=True)
    assert kept.stat().st_mtime == 0
    assert again.occupancy.to_yaml() == first.occupancy.to_yaml()
    assert {capsule[0] for capsule in again.occupancy.capsules} == {"arm"}


def test_speeds_and_forces_that_a_model_does_not_limit_are_unlimited(strange: Path) -> None:
    pytest.importorskip("mujoco")
    robot = pdoik.Robot.from_mjcf(strange)
    assert np.isinf(robot.velocity).all()
    assert not (robot.effort == 1e9).any()


def test_a_urdf_and_its_mjcf_tell_the_same_of_a_robot(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    pin = pytest.importorskip("pinocchio")
    for name, text in (("arm.urdf", ARM_URDF), ("arm.xml", ARM_MJCF)):
        (tmp_path / name).write_text(text.format(mass=1))
    urdf, mjcf = (RobotDescription.of(tmp_path / name) for name in ("arm.urdf", "arm.xml"))
    assert (urdf.kind, mjcf.kind) == ("urdf", "mjcf")
    assert (urdf.tree.tag, mjcf.tree.tag) == ("robot", "mujoco")
    assert urdf.facts.arm == mjcf.facts.arm == JOINTS
    assert (urdf.facts.root, mjcf.facts.root) == ("base", "upper")
    assert urdf.facts.joints["elbow"].upper == 2.5
    assert mjcf.facts.joints["elbow"].upper == pytest.approx(np.radians(140))
    assert urdf.facts.mass_moved_by("elbow") == mjcf.facts.mass_moved_by("elbow") == 1.0
    q = np.random.default_rng(5).uniform(-2, 2, (20, 2))
    assert np.allclose(urdf.gravity_torque(JOINTS, q), mjcf.gravity_torque(JOINTS, q))
    assert np.abs(urdf.gravity_torque(JOINTS, q)).max() > 1.0
    assert mjcf.mujoco is mjcf.mujoco
    assert urdf.pinocchio().nq == 2
    assert urdf.pinocchio(floats=True).joints[1].nv == 6
    with pytest.raises(LoadError, match=r"arm\.xml: its base floats; expected a <freejoint/>"):
        mjcf.pinocchio(floats=True)
    text = RobotDescription.of_text(urdf.text)
    assert text.facts.joints == urdf.facts.joints
    assert isinstance(text.pinocchio(), pin.Model)
    with pytest.raises(LoadError, match="reads an MJCF from a file"):
        RobotDescription.of_text(mjcf.text).pinocchio()


def test_joints_of_a_urdf_are_those_that_the_robot_has() -> None:
    robot = pdoik.Robot.builtin("panda")
    joints = {each.name: each for each in urdf_joints(tree_of(pdoik.urdf_text("panda")))}
    q = np.clip(0.0, robot.lower, robot.upper)
    for name, lower in zip(robot.joint_names, robot.lower, strict=True):
        joint = joints[name]
        assert joint.limit("lower") == pytest.approx(lower)
        assert np.linalg.norm(joint.axis) == pytest.approx(1.0)
        moved = np.linalg.inv(robot.fk(q, joint.parent)) @ robot.fk(q, joint.child)
        assert np.allclose(moved[:3, 3], joint.T_parent_child[:3, 3])


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ('<joint name="a" type="fixed"/>', "joint 'a': expected <parent> and <child>"),
        (
            '<joint name="a" type="revolute"><parent link="b"/><child link="c"/>'
            '<limit upper="far"/></joint>',
            "joint 'a': limit: upper='far' is no number",
        ),
    ],
)
def test_what_is_wrong_with_a_joint_is_said(joint: str, message: str) -> None:
    text = f'<robot name="r"><link name="b"/><link name="c"/>{joint}</robot>'
    with pytest.raises(LoadError, match=message):
        _ = RobotDescription.of_text(text).facts
