"""Masses and their centre: Pinocchio's, MuJoCo's, and the figures we know."""

import json
import os
import re
from pathlib import Path

import numpy as np
import pytest

import pdoik
from random_urdf import RandomUrdf, random_urdf
from references import PinocchioRobot
from samples import random_configuration
from trees import H1_XML, LEFT, by_name

SEEDS = range(15)


@pytest.fixture(scope="module")
def h1() -> pdoik.Robot:
    return pdoik.Robot.builtin("h1")


def test_h1_weighs_51_60_kg_and_its_mass_is_centred_0_938_m_above_its_ankles(
    h1: pdoik.Robot,
) -> None:
    assert h1.total_mass == pytest.approx(51.60, abs=0.005)
    assert h1.link_masses.sum() == pytest.approx(h1.total_mass, abs=1e-12)
    q = np.zeros(h1.dof)
    height = h1.center_of_mass(q)[2] - h1.fk(q, LEFT)[2, 3]
    assert height == pytest.approx(0.938, abs=5e-4)


def test_with_the_newer_masses_they_are_59_34_kg_and_0_895_m() -> None:
    beside = Path(__file__).resolve().parents[4] / "shared"
    path = Path(os.environ.get("PDOIK_SHARED", beside)) / "robots" / "h1_figures.json"
    if not path.exists():
        pytest.skip("needs h1_figures.json from the shared material (PDOIK_SHARED or ../shared)")
    links = json.loads(path.read_text())["sources"]["unitree_ros_urdf"]["links"]
    replaced = 0

    def newer(match: re.Match[str]) -> str:
        nonlocal replaced
        replaced += 1
        figures, text = links[match[1]], match[0]
        xyz = " ".join(map(str, figures["com_xyz"]))
        text, at = re.subn(r'(<inertial>\s*<origin xyz=")[^"]*', rf"\g<1>{xyz}", text)
        text, mass = re.subn(r'(<mass value=")[^"]*', rf"\g<1>{figures['mass']}", text)
        assert at == mass == 1
        return text

    xml = re.sub(r'<link name="(\w+)">.*?</link>', newer, H1_XML, flags=re.DOTALL)
    assert replaced == 20
    robot = pdoik.Robot.from_urdf(xml, tip_link=LEFT)
    q = np.zeros(robot.dof)
    assert robot.total_mass == pytest.approx(59.34, abs=0.005)
    height = robot.center_of_mass(q)[2] - robot.fk(q, LEFT)[2, 3]
    assert height == pytest.approx(0.895, abs=5e-4)


def agree_on_mass(
    robot: pdoik.Robot, reference: PinocchioRobot, urdf: RandomUrdf, q: np.ndarray
) -> None:
    reference.set(urdf.positions(by_name(robot, q)))
    com = robot.center_of_mass(q)
    np.testing.assert_allclose(com, reference.center_of_mass(robot.base_link), rtol=0, atol=1e-12)
    columns = reference.center_of_mass_jacobian(robot.base_link)
    J = np.stack([columns[name] for name in robot.joint_names], axis=1)
    for follower, mimic in urdf.mimics.items():
        J[:, robot.joint_names.index(mimic.of)] += mimic.multiplier * columns[follower]
    np.testing.assert_allclose(robot.center_of_mass_jacobian(q), J, rtol=0, atol=1e-12)


@pytest.mark.parametrize("base", ["pelvis", LEFT, "right_elbow_link"])
def test_h1_s_centre_of_mass_and_its_jacobian_are_pinocchio_s_from_any_base(
    base: str, rng: np.random.Generator
) -> None:
    robot = pdoik.Robot.builtin("h1", base_link=base)
    reference = PinocchioRobot.floating(H1_XML)
    urdf = RandomUrdf(xml=H1_XML, links=robot.link_names)
    for _ in range(10):
        agree_on_mass(robot, reference, urdf, random_configuration(robot, rng))


@pytest.mark.parametrize("seed", SEEDS)
def test_random_trees_centres_of_mass_are_pinocchio_s_mimic_joints_and_all(
    seed: int, rng: np.random.Generator
) -> None:
    urdf = random_urdf(rng, links=int(rng.integers(4, 14)), mimics=seed % 3)
    reference = PinocchioRobot.floating(urdf.xml)
    for base in [None, *urdf.links]:
        try:
            robot = pdoik.Robot.from_urdf(urdf.xml, base_link=base)
        except pdoik.LoadError as error:
            assert "no position satisfies the limits of both" in str(error)  # noqa: PT017
            return
        agree_on_mass(robot, reference, urdf, random_configuration(robot, rng))


def test_h1_s_centre_of_mass_and_its_jacobian_are_mujoco_s(rng: np.random.Generator) -> None:
    mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")
    from bench.humanoid.world.model import build_world
    from bench.humanoid.world.robot import FREE

    robot = pdoik.Robot.builtin("h1", base_link=LEFT)
    world = build_world(FREE)
    model, foot = world.model, world.feet[0]
    for _ in range(10):
        q = random_configuration(robot, rng)
        data = world.standing_data(q)
        R, p = data.xmat[foot].reshape(3, 3), data.xpos[foot]
        com = data.subtree_com[world.root]
        np.testing.assert_allclose(robot.center_of_mass(q), R.T @ (com - p), rtol=0, atol=1e-9)
        J, J_p, J_r = (np.zeros((3, model.nv)) for _ in range(3))
        mujoco.mj_jacSubtreeCom(model, data, J, world.root)
        mujoco.mj_jacBody(model, data, J_p, J_r, foot)
        seen = R.T @ (J - J_p - np.cross(J_r.T, com - p).T)[:, world.dof_index]
        np.testing.assert_allclose(robot.center_of_mass_jacobian(q), seen, rtol=0, atol=1e-9)
