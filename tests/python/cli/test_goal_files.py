"""Goals and poses from files, locks, tools and all solutions at the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import pdoik
from command_line import REACHABLE, misuse, run, solve
from conftest import ROBOTS
from pdoik.cli.goal_file import read_goal_file
from pdoik.cli.grasp_file import read_grasp_file
from references import PinocchioRobot
from trees import H1_XML, TIPS, by_name, crouch, errors

DOWN = [3.14159265358979, 0.0, 0.0]
POSE = {"xyz": [0.4, 0.1, 0.5], "rpy": DOWN}
CHECKED = ("--json", "--max-time", "5")
QUOTED = Rotation.from_euler("xyz", DOWN).as_matrix()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "goals.yaml"


def write(file: Path, *goals: Any) -> Path:
    file.write_text(yaml.safe_dump(list(goals)))
    return file


def ask(*arguments: str | Path) -> Any:
    """What pdoik solve panda says in JSON."""
    outcome = run("solve", "panda", *CHECKED, *arguments)
    assert outcome.exit_code == 0, outcome.output
    return json.loads(outcome.stdout, parse_constant=pytest.fail)


def tip(q: Any, tool: np.ndarray | None = None) -> np.ndarray:
    """Of the Panda by Pinocchio, (4, 4)."""
    pinocchio = PinocchioRobot.from_xml((ROBOTS / "panda.urdf").read_text())
    robot = pdoik.Robot.builtin("panda")
    pinocchio.set(by_name(robot, np.array(q)))
    T = pinocchio.pose(robot.base_link, robot.tip_links[0])
    return T if tool is None else T @ tool


def frame(xyz: Any, R: Any = QUOTED) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3], T[:3, :3] = xyz, R
    return T


def off_axis(T: np.ndarray, axis: int, wanted: Any) -> float:
    wanted = np.array(wanted) / np.linalg.norm(wanted)
    return float(np.arccos(np.clip(T[:3, axis] @ wanted, -1, 1)))


TOOL = frame([0.0, 0.0, 0.12], Rotation.from_euler("xyz", [0.3, 0, 0]).as_matrix())


def met_pose(T: np.ndarray) -> bool:
    return max(errors(frame(POSE["xyz"]), T)) < 3e-5


@pytest.mark.parametrize(
    ("goal", "tool", "holds"),
    [
        ({"pose": POSE}, None, met_pose),
        ({"pose": {"xyz": POSE["xyz"], "wxyz": [0, 1, 0, 0]}}, None, met_pose),
        ({"pose": {"matrix": frame(POSE["xyz"]).tolist()}}, None, met_pose),
        ({"pose": POSE, "tool": {"xyz": [0, 0, 0.12], "rpy": [0.3, 0, 0]}}, TOOL, met_pose),
        ({"tip": "panda_link8", "pose": POSE, "priority": "position"}, None, met_pose),
        (
            {"pose": POSE, "position": [[-0.2, 0, 0.1], [0.1, 0, float("inf")]]},
            None,
            lambda T: (
                0.2 - 3e-5 <= T[0, 3] <= 0.5 + 3e-5
                and abs(T[1, 3] - 0.1) < 3e-5
                and T[2, 3] <= 0.4 + 3e-5  # the frame's z points down
            ),
        ),
        (
            {"pose": POSE, "rotation": [[-0.2, 0, -3.1415926], [0.2, 0, 3.1415926]]},
            None,
            lambda T: errors(frame(POSE["xyz"]), T, 0.0, np.array([0.2, 0, 3.1415927]))[1] < 3e-5,
        ),
        (
            {"position": [0.4, 0.1, 0.5], "position_tolerance": 1e-3},
            None,
            lambda T: np.linalg.norm(T[:3, 3] - POSE["xyz"]) < 1.1e-3,
        ),
        (
            {"position": [[0.3, -0.1, 0.4], [0.35, 0.1, 0.45]]},
            None,
            lambda T: (np.abs(T[:3, 3] - [0.325, 0, 0.425]) < [0.02503, 0.10003, 0.02503]).all(),
        ),
        (
            {"axis": {"xyz": POSE["xyz"], "of": "x", "direction": [0, 1, -1]}},
            None,
            lambda T: off_axis(T, 0, [0, 1, -1]) < 3e-5 and abs(T[0, 3] - 0.4) < 3e-5,
        ),
        (
            {"axis": {"xyz": POSE["xyz"], "rpy": DOWN, "cone": 0.1}, "weight": 2},
            None,
            lambda T: off_axis(T, 2, [0, 0, -1]) < 0.1 + 3e-5,
        ),
        (
            {"look_at": {"point": [1, 0.2, 0.1], "axis": "x"}},
            None,
            lambda T: off_axis(T, 0, np.array([1, 0.2, 0.1]) - T[:3, 3]) < 3e-5,
        ),
        ({"look_at": [1, 0, 0]}, None, lambda T: off_axis(T, 2, [1, 0, 0] - T[:3, 3]) < 3e-5),
    ],
)  # fmt: skip
def test_a_goal_of_a_file_is_met(
    goal: Any, tool: np.ndarray | None, holds: Callable[[np.ndarray], bool], file: Path
) -> None:
    content = ask("--goals", write(file, goal))
    assert content["success"]
    assert content["goals"][0]["type"]
    assert holds(tip(content["q"], tool))


def test_all_of_a_list_is_met_and_a_wish_need_not(file: Path) -> None:
    away = {"position": [3, 0, 0], "soft": True}
    goals = [{"position": POSE["xyz"]}, {"look_at": [0.4, 0.1, 0.0]}, away]
    T = tip(ask("--goals", write(file, *goals))["q"])
    assert np.linalg.norm(T[:3, 3] - POSE["xyz"]) < 3e-5
    assert off_axis(T, 2, [0, 0, -1]) < 3e-5


def test_tips_are_those_that_the_file_names(file: Path, tmp_path: Path) -> None:
    robot = pdoik.Robot.from_urdf(H1_XML, tip_link=TIPS)
    left, right = TIPS[2:]
    q = crouch(robot)
    T = np.linalg.inv(robot.fk(q, left)) @ robot.fk(q, right)
    goals = (
        {"tip": left, "position": robot.fk(q, left)[:3, 3].tolist()},
        {"tip": right, "relative_to": left, "pose": {"matrix": T.tolist()}},
        {"center_of_mass": [[-0.1, -0.05, -np.inf], [0.1, 0.05, np.inf]]},
    )
    arguments = ("--no-self-collision", *CHECKED, "--goals", write(file, *goals))
    outcome = run("solve", "h1", *arguments)
    assert outcome.exit_code == 0, outcome.output
    content = json.loads(outcome.stdout)
    pinocchio = PinocchioRobot.floating(H1_XML)
    pinocchio.set(dict(zip(content["joint_names"], content["q"], strict=True)))
    assert max(errors(T, pinocchio.pose(left, right))) < 3e-5
    com = pinocchio.center_of_mass(content["base_link"])
    np.testing.assert_allclose(com, content["center_of_mass"], atol=1e-9)
    assert (np.abs(com[:2]) < [0.1001, 0.0501]).all()
    written = run("solve", "h1", *arguments, "--report", tmp_path / "case.json")
    assert written.exit_code == 0
    assert run("report", tmp_path / "case.json").exit_code == 0
    unnamed = write(file, {"position": [0.1, 0.2, 0.3]})
    misuse(run("solve", "h1", "--goals", unnamed), "goals.yaml: goals[0].tip: is missing", left)


BAD = {
    "no list": ("pose: 1", ["expected a list of requirements"]),
    "no YAML": ("[", ["not YAML"]),
    "no kind": ("- {tip: panda_link8}", ["goals[0]", "expected one of pose, position", "got none"]),
    "two kinds": ("- {pose: {}, look_at: [1, 0, 0]}", ["goals[0]", "got pose, look_at"]),
    "unknown": ("- {position: [0, 0, 1], colour: red}", ["goals[0]", "'colour'", "weight"]),
    "no frame": ("- {pose: {xyz: [0, 0, 1]}}", ["goals[0].pose", "expected rpy, wxyz or matrix"]),
    "no number": ("- {pose: {xyz: [0, 0, a], rpy: [0, 0, 0]}}", ["goals[0].pose.xyz", "numbers"]),
    "quaternion": ("- {pose: {wxyz: [1, 1, 0, 0]}}", ["goals[0].pose.wxyz", "norm 1.414"]),
    "matrix": ("- {pose: {matrix: [[1]]}}", ["goals[0].pose.matrix", "(4, 4)"]),
    "mirrored": (
        "- pose: {matrix: [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}",
        ["goals[0].pose.matrix", "determinant -1"],
    ),
    "both turns": ("- {pose: {rpy: [0,0,0], wxyz: [1,0,0,0]}}", ["goals[0].pose", "got both"]),
    "box": (
        "- {position: [0, 0, 1]}\n- {position: [[1, 1, 1], [0, 0, 0]]}",
        ["goals[1]", "lower bound"],
    ),
    "soft": ("- {position: [0, 0, 1], soft: perhaps}", ["goals[0].soft", "true or false"]),
    "priority": ("- {pose: {}, priority: first}", ["goals[0].priority", "position, both"]),
    "tolerance": ("- {position: [0, 0, 1], position_tolerance: 1mm}", ["position_tolerance"]),
    "axis": ("- {axis: {xyz: [0, 0, 1]}}", ["goals[0].axis", "expected one of direction"]),
    "letter": ("- {look_at: {point: [1, 0, 0], axis: w}}", ["goals[0].look_at.axis", "x, y, z"]),
    "direction": ("- {axis: {direction: [0, 0, 0]}}", ["goals[0].axis.direction", "direction"]),
    "mass": ("- {center_of_mass: [[0, 0, 0], [1, 1, 1]], soft: true}", ["goals[0]", "'soft'"]),
    "tip": ("- {tip: hand, position: [0, 0, 1]}", ["goals[0].tip", "'hand'", "a link of"]),
    "frame of": (
        "- {tip: panda_link8, relative_to: hand, position: [0, 0, 1]}",
        ["goals[0].relative_to", "'hand'"],
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_goal_file_is_misuse_and_names_the_entry(name: str, file: Path) -> None:
    text, words = BAD[name]
    file.write_text(text)
    misuse(run("solve", "panda", "--goals", file), "goals.yaml", *words)


def test_a_turn_to_the_opposite_direction_is_one(file: Path) -> None:
    for direction in ([0, 0, -1], [0, 0, 1], [0.1, 0, -1]):
        (goal,) = read_goal_file(write(file, {"axis": {"direction": direction}}))
        R = goal.T_base_tip[:3, :3]
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)
        assert off_axis(goal.T_base_tip, 2, direction) < 1e-7


def grasps(path: Path, text: str) -> Path:
    file = path / "grasps.csv"
    file.write_text(text)
    return file


def test_any_pose_of_a_table_will_do_the_cheapest_with_costs(tmp_path: Path) -> None:
    rows = "3, 0, 0.5, 0, 1, 0, 0\n\n# near\n0.4, 0.1, 0.5, 0, 1, 0, 0\n"
    content = ask("--any", grasps(tmp_path, rows))
    assert content["goal_index"] == 1
    assert met_pose(tip(content["q"]))
    named = (
        "cost,qw,qx,qy,qz,x,y,z\n1,0,1,0,0,3,0,0.5\n5,0,1,0,0,0.4,0.1,0.5\n2,0,1,0,0,0.5,0,0.4\n"
    )
    file, case = grasps(tmp_path, named), tmp_path / "case.json"
    content = ask("--any", file)
    assert content["goal_index"] == 2
    np.testing.assert_allclose(tip(content["q"]), frame([0.5, 0, 0.4]), atol=3e-5)
    np.testing.assert_allclose(content["T_base_tip"], frame([0.5, 0, 0.4]), atol=1e-6)
    told = run("solve", "panda", "--any", file, "--report", case, "--picture", tmp_path / "a.png")
    assert f"pose 3 of 3 in {file}, at a cost of 2" in told.stdout
    assert run("report", case).exit_code == 0
    poses, costs = read_grasp_file(file)
    assert costs is not None
    assert costs.tolist() == [1, 5, 2]
    assert poses.shape == (3, 4, 4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["expected a row x y z qw"]),
        ("x,y,z,qw,qx,qy,qz\n", ["expected a row"]),
        ("0.4,0,0.5,0,1,0\n", ["line 1", "expected 7 finite numbers", "0.4, 0, 0.5"]),
        ("0.4,0,0.5,0,1,0,0\n0.4,0,nan,0,1,0,0\n", ["line 2", "finite"]),
        ("0.4,0,0.5,1,1,0,0\n", ["line 1", "qw qx qy qz", "norm 1.414"]),
        ("x,y,z,qw,qx,qy,q\n", ["line 1", "expected the columns", "'q'"]),
        ("x,y,z,qw,qx,qy\n0,0,1,1,0,0\n", ["line 1", "there is no qz"]),
        ("x,y,z,qw,qx,qy,qz,x\n", ["'x' 2 times"]),
    ],
)
def test_a_bad_table_of_poses_is_misuse(tmp_path: Path, text: str, words: list[str]) -> None:
    misuse(run("solve", "panda", "--any", grasps(tmp_path, text)), "grasps.csv", *words)


def test_a_lock_is_kept_and_a_tool_is_what_is_at_the_target() -> None:
    locked = ask("--target", REACHABLE, "--lock", "panda_joint3=0.2")
    assert locked["q"][2] == 0.2
    np.testing.assert_allclose(tip(locked["q"]), locked["T_base_tip"], atol=3e-5)
    held = ask("--target", REACHABLE, "--tool", "0 0 0.12 0.3 0 0")
    np.testing.assert_allclose(tip(held["q"], TOOL), held["T_base_tip"], atol=3e-5)


def test_where_a_position_comes_first_both_errors_are_printed() -> None:
    far = "0.8 0.1 0.5 0 3 1"
    assert run("solve", "panda", "--target", far).exit_code == 1
    outcome = run("solve", "panda", "--target", far, "--priority", "position")
    assert outcome.exit_code == 1
    assert outcome.stdout.startswith("not solved: the position is met, and the orientation as near")
    assert "the position is met, the orientation is" in outcome.stdout
    lines = outcome.stdout.splitlines()
    assert any(line.startswith("position error") for line in lines)
    assert any(line.startswith("rotation error") for line in lines)


def test_what_failed_is_told_with_its_tolerance() -> None:
    outcome = solve("--max-time", "1e-9", "--rotation-tolerance", "1e-9")
    assert outcome.exit_code == 1
    assert "off its target, tolerance" in outcome.stdout


def test_all_solutions_are_listed_the_nearest_first(tmp_path: Path) -> None:
    robot = pdoik.Robot.builtin("ur10")
    arguments = ("solve", "ur10", "--target", "0.5 0.3 0.4 3 0.2 0.1", "--all", *CHECKED[1:])
    outcome = run(*arguments, "--report", tmp_path / "case.json")
    assert outcome.exit_code == 0, outcome.output
    assert "all there are" in outcome.stdout
    assert run("report", tmp_path / "case.json").exit_code == 0
    content = json.loads(run(*arguments, "--json").stdout, parse_constant=pytest.fail)
    found = content["solutions"]
    assert content["complete"]
    assert len(found) > 3
    T = frame([0.5, 0.3, 0.4], Rotation.from_euler("xyz", [3, 0.2, 0.1]).as_matrix())
    for each in found:
        np.testing.assert_allclose(robot.fk(each["q"]), T, atol=3e-5)
        start = robot.mid_configuration()
        assert each["distance"] == pytest.approx(np.linalg.norm(np.array(each["q"]) - start))
    distances = [each["distance"] for each in found]
    assert distances == sorted(distances)
    few = run(*arguments, "--limit", "2")
    assert few.stdout.startswith("2 solutions, as many as --limit lets be")
    none = run("solve", "ur10", "--target", "5 0 0 0 0 0", "--all")
    assert none.exit_code == 1
    assert none.stdout.startswith("no solution: out of reach")
    redundant = run("solve", "panda", "--target", REACHABLE, "--all", "--max-time", "0.05")
    assert "coverage" in redundant.stdout


def test_all_solutions_are_sorted_from_the_start_and_clear_of_obstacles(tmp_path: Path) -> None:
    np.save(tmp_path / "cloud.npy", np.array([[0.6, 0.2, 0.9], [0.3, 0.0, 0.7]]))
    q0 = "1 -1 1 0 1 0"
    outcome = run(
        *("solve", "ur10", "--target", "0.5 0.3 0.4 3 0.2 0.1", "--all", "--json", "--q0", q0),
        *("--cloud", tmp_path / "cloud.npy", "--leaf", "0"),
    )
    assert outcome.exit_code == 0, outcome.output
    found = json.loads(outcome.stdout)["solutions"]
    start = np.array([float(word) for word in q0.split()])
    distances = [float(np.linalg.norm(np.array(each["q"]) - start)) for each in found]
    assert distances == sorted(distances)
    assert min(each["clearance"] for each in found) > -1e-5


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (("--target", "0.4 0.1 0.5 180 0 0"), "--target"),
        (("--target", REACHABLE, "--tool", "0 0 0.1 0 0 90"), "--tool"),
        (("--target", REACHABLE, "--q0", "0 -30 0 -2 0 2 0"), "--q0"),
        (("--target", REACHABLE, "--lock", "panda_joint5=45"), "--lock"),
        (("--target", REACHABLE, "--rotation-tolerance", "10"), "--rotation-tolerance"),
    ],
)
def test_degrees_are_warned_of(arguments: tuple[str, ...], option: str) -> None:
    outcome = run("solve", "panda", "--max-time", "0.01", *arguments)
    assert f"warning: {option}: " in outcome.stderr
    assert "degrees? It is taken as radians" in outcome.stderr
    assert "warning" not in run("solve", "panda", "--target", "0.4 0.1 0.5 6.2 0 0").stderr


def test_degrees_in_a_file_are_warned_of(file: Path) -> None:
    write(file, {"pose": {"xyz": [0.4, 0.1, 0.5], "rpy": [180, 0, 0]}})
    outcome = run("solve", "panda", "--max-time", "0.01", "--goals", file)
    assert "goals.yaml: goals[0].pose.rpy: 180 rad is more than a whole turn" in outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], ["no goal given", "--goals"]),
        (["--target", REACHABLE, "--any", "a.csv"], ["--target and --any", "one of them"]),
        (["--any", "a.csv", "--all"], ["--all"]),
        (["--goals", "none.yaml"], ["none.yaml", "no such file"]),
        (["--any", "none.csv"], ["none.csv", "no such file"]),
        (["--target", REACHABLE, "--limit", "3"], ["--limit", "--all"]),
        (["--target", REACHABLE, "--all", "--limit", "0"], ["limit is 0"]),
        (["--target", REACHABLE, "--lock", "joint9=1"], ["--lock", "'joint9=1'", "panda_joint1"]),
        (["--target", REACHABLE, "--lock", "panda_joint1"], ["--lock", "finite number"]),
        (["--target", REACHABLE, "--lock", "panda_joint1=nan"], ["--lock", "finite number"]),
        (["--target", REACHABLE, "--tool", "1 2"], ["--tool", "2 numbers"]),
    ],
)
def test_options_that_make_no_sense_are_misuse(arguments: list[str], words: list[str]) -> None:
    misuse(run("solve", "panda", *arguments), *words)
