"""--frame and --without of --scene: as load_scene's, in every command that takes a scene."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import pdoik
from command_line import misuse, run, solve

pytest.importorskip("mujoco", reason="pip install mujoco")

MJCF = """<mujoco><worldbody>
  <body name="stand" pos="2 1 0.5" euler="0 0 90"/>
  <body name="table" pos="2 1.6 0.6"><geom type="box" size="0.3 0.2 0.02"/></body>
  <body name="block" pos="1.9 1.4 1.0"><geom type="box" size="0.2 0.2 0.2"/></body>
</worldbody></mujoco>"""
SDF = """<sdf version="1.7"><world name="cell">
  <model name="stand"><static>1</static><pose>2 1 0.5 0 0 1.570796326794897</pose>
    <link name="top"/></model>
  <model name="table"><static>1</static><pose>2 1.6 0.6 0 0 0</pose><link name="top">
    <collision name="c"><geometry><box><size>0.6 0.4 0.04</size></box></geometry></collision>
  </link></model>
  <model name="block"><static>1</static><pose>1.9 1.4 1 0 0 0</pose><link name="it">
    <collision name="c"><geometry><box><size>0.4 0.4 0.4</size></box></geometry></collision>
  </link></model>
</world></sdf>"""
WORLDS = {"world.xml": MJCF, "world.sdf": SDF}


@pytest.fixture(params=WORLDS)
def world(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A stand for the robot, a table before it, and a block where its hand is to go."""
    path = tmp_path / request.param
    path.write_text(WORLDS[request.param])
    return path


def test_a_solve_is_in_the_frame_that_is_named_and_without_what_is_named(world: Path) -> None:
    options = ("--scene", world, "--frame", "stand", "--without", "block")
    told = json.loads(solve("--json", *options).stdout)
    assert told["status"] == "solved"
    assert len(told["scene"]["shapes"]) == 1
    robot = pdoik.Robot.builtin("panda")
    scene = pdoik.load_scene(world, robot=robot, frame="stand", without=["block"])
    (table,) = scene.shapes
    np.testing.assert_allclose(table.T_base_shape[:3, 3], [0.6, 0.0, 0.1], atol=1e-9)
    verdict = pdoik.Solver(robot).judge(told["T_base_tip"], told["q"], scene)
    assert told["clearance"] == pytest.approx(verdict.clearance, abs=1e-9)
    assert verdict.clearance < 0.5

    shut = run("solve", "panda", "--target", "0.4 0.1 0.5 1 0 0 0", *options[:4])  # in the block
    assert shut.exit_code == 1
    assert "block" in shut.stdout
    far = json.loads(solve("--json", "--scene", world).stdout)  # in the world's own frame
    assert far["clearance"] > 0.5


@pytest.mark.parametrize(
    "command",
    [("solve", "panda", "--target", "0.4 0.1 0.5 1 0 0 0"), ("view", "panda", "--no-open")],
)
def test_names_that_a_scene_has_not_are_refused(
    command: tuple[str, ...], world: Path, tmp_path: Path
) -> None:
    misuse(run(*command, "--scene", world, "--frame", "nobody"), world.name, "'nobody'")
    misuse(run(*command, "--scene", world, "--without", "nobody"), world.name, "'nobody'")
    misuse(run(*command, "--frame", "stand"), "--frame", "--scene")
    misuse(run(*command, "--without", "block"), "--without", "--scene")
    own = tmp_path / "own.yaml"
    own.write_text("shapes: [{name: ball, sphere: 0.1, position: [1, 0, 1]}]\n")
    misuse(run(*command, "--scene", own, "--frame", "stand"), "own.yaml", "names no frames")
    misuse(run(*command, "--scene", own, "--without", "cup"), "own.yaml", "'cup'")


def test_a_path_and_the_place_of_its_base_are_found_in_the_frame_that_is_named(
    world: Path, tmp_path: Path
) -> None:
    seam = tmp_path / "seam.csv"
    rows = [f"0.4,{y:.3f},0.5,1,0,0,0" for y in np.linspace(-0.1, 0.1, 9)]
    seam.write_text("\n".join(["x,y,z,qx,qy,qz,qw", *rows]) + "\n")
    options = ("--robot", "panda", "--scene", world, "--frame", "stand")
    open_way = run("path", seam, *options, "--without", "block", "--json")
    assert open_way.exit_code == 0, open_way.output
    assert json.loads(open_way.stdout)["clearance"] < 0.5
    assert run("path", seam, *options, "--json").exit_code == 1
    misuse(run("path", seam, *options[:3], world, "--frame", "nobody"), "'nobody'")

    place = run("place", seam, *options, "--without", "block", "--x", "0:0.1:0.1")
    assert place.exit_code == 0, place.output
    misuse(run("place", seam, *options[:4], "--without", "nobody", "--x", "0:0.1:0.1"), "'nobody'")
