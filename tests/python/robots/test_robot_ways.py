"""`Robot.from_urdf`, `from_xacro`, `from_mjcf` and `from_description`, and the command line."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
import trimesh

import pdoik
from command_line import misuse, run
from pdoik.descriptions import installed  # inside: what is installed is replaced
from pdoik.errors import LoadError, RobotWarning

MACROS = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="0.4"/>
  <xacro:property name="mesh" value="package://arm_description/meshes/rod.stl"/>
  <link name="base"/>
  <link name="tool"><collision><geometry><mesh filename="${mesh}"/></geometry></collision></link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="tool"/>
    <origin xyz="$(arg length) 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
</robot>"""
LOOP = """<mujoco model="loop">
  <compiler meshdir="parts"/>
  <include file="defaults.xml"/>
  <asset><mesh name="rod" file="rod.stl"/></asset>
  <worldbody>
    <body name="left" pos="0 0.1 0" childclass="arm"><joint name="a"/><geom class="touching"/>
      <body name="left_tip" pos="0.3 0 0"><joint name="b"/><geom class="touching"/>
        <site name="grip" pos="0.1 0 0"/></body></body>
    <body name="right" pos="0 -0.1 0" childclass="arm"><joint name="c"/><geom class="touching"/>
      <geom class="looks"/></body>
    <body name="ball" pos="1 0 0"><freejoint/><geom size="0.05"/></body>
  </worldbody>
  <equality><connect body1="left_tip" body2="right" anchor="0.3 0 0"/></equality>
</mujoco>"""
DEFAULTS = """<mujoco><default><default class="arm">
  <joint axis="0 0 1" range="-90 90"/><geom type="mesh" mesh="rod"/><site size="0.01"/>
  <default class="touching"><geom group="3"/></default>
  <default class="looks"><geom contype="0" conaffinity="0"/></default>
</default></default></mujoco>"""


def rod() -> trimesh.Trimesh:
    """Along x, and quick to fit."""
    made = trimesh.creation.capsule(height=0.3, radius=0.02, count=[8, 8])
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, [0, 1, 0])
    return made.apply_transform(turn)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is a package of ROS in all but its name."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder = tmp_path / "a clone & more"
    for name in ("urdf", "meshes"):
        (folder / name).mkdir(parents=True)
    (folder / "urdf" / "arm.urdf").write_text(MACROS)
    rod().export(folder / "meshes" / "rod.stl")
    return folder


@pytest.fixture
def loop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An MJCF with most of what a URDF has not."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "parts").mkdir()
    (tmp_path / "defaults.xml").write_text(DEFAULTS)
    rod().export(tmp_path / "parts" / "rod.stl")
    path = tmp_path / "loop.xml"
    path.write_text(LOOP)
    return path


def test_from_urdf_takes_xacro_and_packages(
    package: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("xacro")
    file = package / "urdf" / "arm.urdf"
    told = {"arm_description": package}
    robot = pdoik.Robot.from_urdf(file, packages=told, arguments={"length": "0.7"}, hulls=True)
    assert robot.fk([0.0])[0, 3] == pytest.approx(0.7)
    assert {capsule[0] for capsule in robot.occupancy.capsules} == {"tool"}
    assert pdoik.Robot.from_xacro(file).fk([0.0])[0, 3] == pytest.approx(0.4)
    with pytest.raises(LoadError, match=r"arm\.urdf: no hulls: .*package 'arm_description' is no"):
        pdoik.Robot.from_urdf(file, hulls=True)
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    again = pdoik.Robot.from_urdf(file, hulls=True)
    assert again.occupancy == robot.occupancy
    monkeypatch.setenv("HOME", str(tmp_path))
    home = "~/" + str(file.relative_to(tmp_path))
    assert pdoik.Robot.from_urdf(home, T_world_base=np.diag([-1.0, -1, 1, 1])).base_link == "world"


def test_from_mjcf_reads_includes_defaults_and_open_loops(loop: Path) -> None:
    pytest.importorskip("mujoco")
    robot = pdoik.Robot.from_mjcf(loop, hulls=True)
    assert robot.name == "loop"
    assert set(robot.joint_names) == {"a", "b", "c"}  # the loop is open, the ball stands
    assert set(robot.tip_links) == {"grip", "right", "ball"}
    assert robot.upper == pytest.approx(np.full(3, np.pi / 2))
    assert {c[0] for c in robot.occupancy.capsules} == {"left", "left_tip", "right", "ball"}
    seen = dict(zip(robot.joint_names, (0.3, -0.5, 0.2), strict=True))
    q = [seen[name] for name in robot.joint_names]
    at = [0.3 * np.cos(0.3) + 0.1 * np.cos(-0.2), 0.1 + 0.3 * np.sin(0.3) + 0.1 * np.sin(-0.2), 0]
    assert robot.fk(q, "grip")[:3, 3] == pytest.approx(at, abs=1e-9)


def test_who_takes_the_wrong_way_is_told_the_right_one(loop: Path, package: Path) -> None:
    pytest.importorskip("mujoco")
    urdf = package / "urdf" / "arm.urdf"
    urdf.write_text('<robot name="a"><link name="base"/></robot>')
    with pytest.raises(LoadError, match=r"loop\.xml is an MJCF, which Robot\.from_mjcf reads"):
        pdoik.Robot.from_urdf(loop)
    with pytest.raises(LoadError, match=r"arm\.urdf is a URDF, which Robot\.from_urdf reads"):
        pdoik.Robot.from_mjcf(urdf)
    with pytest.raises(LoadError, match=r"names are for Robot\.from_description"):
        pdoik.Robot.from_urdf("ur5e")
    with pytest.raises(LoadError, match=r"no robot 'pamda'.*nearest: panda"):
        pdoik.Robot.from_description("pamda")
    assert pdoik.Robot.from_description("Panda").name == "panda"
    with pytest.raises(LoadError, match="arguments are of xacro files"):
        pdoik.Robot.from_urdf(urdf, arguments={"a": "b"})
    with pytest.raises(LoadError, match=r"no hulls: none of the links .*; hulls=False leaves"):
        pdoik.Robot.from_urdf(urdf, hulls=True)
    with pytest.raises(LoadError, match="a folder"):
        pdoik.load_robot(package.parent)


def test_hulls_that_cannot_be_kept_or_read_back_are_fitted(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PDOIK_CACHE", str(tmp_path / "cache"))
    pytest.importorskip("xacro")
    (package / "package.xml").write_text("<package><name>arm_description</name></package>")
    file, cache = package / "urdf" / "arm.urdf", tmp_path / "cache"
    cache.write_text("")  # a file where the folder would be
    first = pdoik.Robot.from_urdf(file, hulls=True).occupancy
    cache.unlink()
    assert pdoik.Robot.from_urdf(file, hulls=True).occupancy == first
    texts = {kept: kept.read_text() for kept in (cache / "hulls").iterdir()}
    assert texts
    for kept, text in texts.items():
        kept.write_text(text[: len(text) // 2])
    assert pdoik.Robot.from_urdf(file, hulls=True).occupancy == first
    assert {kept: kept.read_text() for kept in (cache / "hulls").iterdir()} == texts


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_a_robot_whose_first_joint_goes_about_stands(kind: str) -> None:
    urdf = f"""<robot name="rover"><link name="map"/><link name="chassis"/><link name="arm"/>
      <joint name="drive" type="{kind}"><parent link="map"/><child link="chassis"/>
        <origin xyz="1 2 0"/><axis xyz="0 0 1"/></joint>
      <joint name="turn" type="continuous"><parent link="chassis"/><child link="arm"/>
        <axis xyz="0 0 1"/></joint></robot>"""
    with pytest.warns(RobotWarning) as said:
        robot = pdoik.Robot.from_urdf(urdf)
    assert any(f"joint 'drive' is {kind}: the robot stands" in str(w.message) for w in said)
    assert robot.fk([0.0])[:3, 3] == pytest.approx([1, 2, 0])
    bounds = np.full(6, -1.0), np.full(6, 1.0)
    with pytest.warns(RobotWarning):
        goes = pdoik.Robot.from_urdf(urdf, base_link="chassis", floating_base=bounds)
    assert goes.dof == 7


def test_a_description_that_is_cloned_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("mujoco")
    pytest.importorskip("robot_descriptions._cache", exc_type=ImportError)
    clone = tmp_path / "clones" / "mujoco_menagerie"
    (clone / "universal_robots_ur5e").mkdir(parents=True)
    (clone / "universal_robots_ur5e" / "ur5e.xml").write_text(
        '<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody></mujoco>'
    )

    def git(*words: str) -> str:
        names = ("-c", "user.name=n", "-c", "user.email=e")
        done = subprocess.run(["git", *names, *words], cwd=clone, check=True, capture_output=True)
        return done.stdout.decode().strip()

    for words in (["init"], ["add", "."], ["commit", "-m", "robot"]):
        git(*words)
    commit = git("rev-parse", "HEAD")
    there = tmp_path / "cloned" / f"{clone.name}-{commit}" / clone.name
    there.parent.mkdir(parents=True)
    clone.rename(there)
    monkeypatch.setenv("ROBOT_DESCRIPTIONS_CACHE", str(tmp_path / "cloned"))
    monkeypatch.setenv("ROBOT_DESCRIPTION_COMMIT", commit)
    robot = pdoik.Robot.from_description("ur5e_mj_description", hulls=False)
    assert list(robot.joint_names) == ["j"]


def test_models_of_the_menagerie_are_known_by_their_short_names(
    tmp_path: Path, loop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("mujoco")
    pytest.importorskip("mujoco_menagerie")
    folder = tmp_path / "menagerie" / "anybotics_anymal_b"
    folder.mkdir(parents=True)
    for name in ("defaults.xml", "parts"):
        loop.with_name(name).rename(folder / name)
    loop.rename(folder / "anymal_b.xml")
    monkeypatch.setenv("MENAGERIE_ROOT", str(folder.parent))
    whole = pdoik.Robot.from_description("anybotics_anymal_b", hulls=False)
    assert whole.name == "loop"
    assert installed.description_of("nothing_like_it") is None
    with pytest.raises(LoadError, match=r"mujoco-menagerie could not get unitree_h1: .*MENAGERIE_"):
        pdoik.Robot.from_description("unitree_h1")


def test_the_command_line_fits_and_pairs_what_load_robot_takes(
    loop: Path, package: Path, tmp_path: Path
) -> None:
    pytest.importorskip("mujoco")
    pytest.importorskip("xacro")
    hulls = tmp_path / "hulls.yaml"
    outcome = run("occupancy", loop, "--max-parts", "1", "--out", hulls)
    assert outcome.exit_code == 0, outcome.output
    outcome = run("pairs", loop, "--occupancy", hulls, "--samples", "50", "--out", tmp_path / "s")
    assert outcome.exit_code == 0, outcome.output
    assert "left_tip and right" in outcome.stdout
    file = package / "urdf" / "arm.urdf"
    misuse(run("occupancy", file), "package 'arm_description' is nowhere", "--package-dir")
    told = ("--package-dir", f"arm_description={package}", "--xacro-arg", "length:=0.9")
    outcome = run("occupancy", file, "--max-parts", "1", "--out", hulls, *told)
    assert outcome.exit_code == 0, outcome.output
    target = ("--goal", "position", "--target", "0.9 0 0", "--tip-link", "tool")
    solved = run("solve", "--robot", file, "--occupancy", hulls, *target, *told)
    assert solved.exit_code == 0, solved.output
    misuse(run("info", file, "--package-dir", "arm=/nowhere"), "--package-dir", "/nowhere")
    misuse(run("info", file, "--xacro-arg", "length=1"), "--xacro-arg", "NAME:=VALUE")
    misuse(run("occupancy", "panda"), "shipped")
    misuse(run("occupancy", "pamda"), "nearest: panda")


MARKED = """\ufeff  \n<robot name="arm"><link name="a"/><link name="b">
  <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def test_a_text_that_begins_with_a_byte_order_mark_is_a_text(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(MARKED.replace("  \n", ""), encoding="utf-8")
    for given in (MARKED, "  " + MARKED, MARKED[1:], file):
        assert pdoik.Robot.from_urdf(given).joint_names == ["j"]
    assert pdoik.Robot.from_urdf(MARKED, hulls=True).occupancy.capsules
