"""pdoik path: whole paths at the command line, judged by Pinocchio; files, timing, pictures."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import pdoik
from command_line import misuse, run
from conftest import ROBOTS
from pdoik.cli.path_file import read_path_file
from pdoik.cli.path_files import timed, write_rows
from pdoik.cli.path_search import search
from references import PinocchioRobot

DOWN = "1,0,0,0"  # qx qy qz qw
LID = "shapes:\n- {name: lid, box: [0.4, 0.4, 0.02], position: [0.6, 0.0, 0.6]}\n"


def line(count: int = 40, y: float = 0.2, x: float = 0.5, z: float = 0.35) -> np.ndarray:
    """Places of a straight seam, (N, 3)."""
    return np.linspace([x, -y, z], [x, y, z], count)


def table(file: Path, places: np.ndarray, names: str = "qx,qy,qz,qw", turn: str = DOWN) -> Path:
    rows = [",".join(f"{value:.9f}" for value in place) + f",{turn}" for place in places]
    file.write_text("\n".join([f"x,y,z,{names}", *rows]) + "\n")
    return file


@pytest.fixture
def seam(tmp_path: Path) -> Path:
    return table(tmp_path / "seam.csv", line())


def answer(*arguments: str | Path, status: int = 0) -> Any:
    """What pdoik path says in JSON."""
    outcome = run("path", *arguments, "--json")
    assert outcome.exit_code == status, outcome.output
    return json.loads(outcome.stdout, parse_constant=pytest.fail)


def poses(name: str, q: Any) -> np.ndarray:
    """Of the tip at configurations, by Pinocchio, (M, 4, 4)."""
    pinocchio = PinocchioRobot.from_xml((ROBOTS / f"{name}.urdf").read_text())
    robot = pdoik.Robot.builtin(name)
    found = []
    for row in np.asarray(q):
        pinocchio.set(dict(zip(robot.joint_names, row.tolist(), strict=True)))
        found.append(pinocchio.pose(robot.base_link, robot.tip_links[0]))
    return np.array(found)


def rows_of(file: Path) -> tuple[list[str], list[list[str]]]:
    with file.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    return header, rows


@pytest.mark.parametrize("robot", ["panda", "ur10", "iiwa14"])
def test_a_seam_is_followed_from_row_to_row(seam: Path, robot: str) -> None:
    told = answer(seam, "--robot", robot)
    assert told["status"] == "whole"
    T = poses(robot, told["q"])
    at = np.array(told["at"])
    wanted = np.array([np.interp(at, np.arange(40), line()[:, k]) for k in range(3)]).T
    assert np.abs(T[:, :3, 3] - wanted).max() < 2e-4
    assert np.abs(T[:, :3, :3] - np.diag([1.0, -1.0, -1.0])).max() < 2e-3


def test_a_line_says_what_came_of_it(seam: Path) -> None:
    outcome = run("path", seam, "--robot", "ur10")
    assert outcome.exit_code == 0
    for word in ("whole", "rows", "length", "largest step", "to limits", "time"):
        assert word in outcome.stdout


def test_a_free_axis_is_turned_about_and_the_tool_is_at_the_seam(seam: Path) -> None:
    told = answer(seam, "--robot", "panda", "--free", "z", "--tool", "0 0 0.1 0 0 0")
    T = poses("panda", told["q"])
    at = np.array(told["at"])
    wanted = np.array([np.interp(at, np.arange(40), line()[:, k]) for k in range(3)]).T
    assert np.abs((T @ [0.0, 0.0, 0.1, 1.0])[:, :3] - wanted).max() < 2e-4
    assert np.abs(T[:, :3, 2] - [0.0, 0.0, -1.0]).max() < 2e-3


@pytest.mark.parametrize(
    ("names", "turn"),
    [
        ("roll,pitch,yaw", "3.141592653589793,0,0"),
        ("qw,qx,qy,qz", "0,1,0,0"),
        ("ax,ay,az", "0,0,-2"),
    ],
)
def test_a_turn_may_be_told_in_other_columns(tmp_path: Path, names: str, turn: str) -> None:
    told = answer(table(tmp_path / "seam.csv", line(), names, turn), "--robot", "ur10")
    T = poses("ur10", told["q"])
    assert np.abs(T[:, :3, 2] - [0.0, 0.0, -1.0]).max() < 2e-3


def test_an_axis_of_the_tool_other_than_z_is_the_one_that_points(tmp_path: Path) -> None:
    file = table(tmp_path / "seam.csv", line(), "ax,ay,az", "0,0,-1")
    told = answer(file, "--robot", "ur10", "--free", "x")
    assert np.abs(poses("ur10", told["q"])[:, :3, 0] - [0.0, 0.0, -1.0]).max() < 2e-3


def test_corners_have_stations_between_them(tmp_path: Path) -> None:
    corners = table(tmp_path / "corners.csv", line(2))
    told = answer(corners, "--robot", "ur10", "--spacing", "0.01")
    assert told["stations"] == 41
    places = poses("ur10", told["q"])[:, :3, 3]
    assert np.abs(places[:, 0] - 0.5).max() < 2e-4
    assert np.abs(np.diff(places[:, 1])).max() < 0.0105


def test_a_yaml_of_poses_is_a_path_of_poses_and_one_of_goals_says_it_itself(
    tmp_path: Path,
) -> None:
    file = tmp_path / "seam.yaml"
    goals = [{"pose": {"xyz": p.tolist(), "rpy": [np.pi, 0.0, 0.0]}} for p in line(12)]
    file.write_text(yaml.safe_dump(goals))
    assert answer(file, "--robot", "ur10", "--free", "z")["status"] == "whole"
    told = answer(file, "--robot", "ur10", "--spacing", "0.01")
    assert told["stations"] > 12
    other = tmp_path / "other.yaml"
    leaning = [
        [{"axis": {"xyz": p.tolist(), "of": "z", "direction": [0, 0, -1]}}] for p in line(12)
    ]
    other.write_text(yaml.safe_dump(leaning))
    assert answer(other, "--robot", "ur10")["status"] == "whole"
    misuse(run("path", other, "--robot", "ur10", "--free", "z"), "--free", "goals")


def test_start_end_lock_and_closed_are_kept(tmp_path: Path, seam: Path) -> None:
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = np.column_stack([0.6 + 0.1 * np.cos(t), 0.1 * np.sin(t), np.full(40, 0.3)])
    told = answer(table(tmp_path / "circle.csv", circle), "--robot", "panda", "--closed")
    assert told["at"][-1] == 40.0
    assert np.allclose(told["q"][0], told["q"][-1], atol=1e-9)
    first = answer(seam, "--robot", "panda")
    start = " ".join(repr(value) for value in first["q"][-1])
    back = table(tmp_path / "back.csv", line()[::-1])
    again = answer(back, "--robot", "panda", "--start", start)
    assert np.allclose(again["q"][0], first["q"][-1], atol=1e-6)
    locked = answer(seam, "--robot", "panda", "--lock", "panda_joint3=0.1")
    assert np.abs(np.array(locked["q"])[:, 2] - 0.1).max() < 1e-9


def test_rows_are_written_by_place(tmp_path: Path, seam: Path) -> None:
    out = tmp_path / "rows.csv"
    told = answer(seam, "--robot", "ur10", "--out", out)
    header, rows = rows_of(out)
    names = pdoik.Robot.builtin("ur10").joint_names
    assert header == ["at", "piece", *(f"q.{name}" for name in names)]
    assert np.allclose([[float(word) for word in row[2:]] for row in rows], told["q"])
    assert {row[1] for row in rows} == {"0"}
    assert sorted(tmp_path.iterdir()) == [out, seam]


def test_a_speed_gives_a_trajectory_that_keeps_it(tmp_path: Path, seam: Path) -> None:
    pytest.importorskip("scipy")
    out = tmp_path / "motion.csv"
    timing = ("--speed", "0.05", "--acceleration", "5", "--rate", "100")
    told = answer(seam, "--robot", "ur10", *timing, "--out", out)
    assert told["timed_is_clear"]
    motion = pdoik.Trajectory.from_csv(out)
    assert np.isclose(motion.duration, told["duration"])
    assert np.allclose(np.diff(motion.time), 0.01)
    places = poses("ur10", motion.q)[:, :3, 3]
    speed = np.linalg.norm(np.diff(places, axis=0), axis=1) / 0.01
    assert speed.max() < 0.0505
    assert np.median(speed) > 0.0495
    assert np.abs(places[:, [0, 2]] - [0.5, 0.35]).max() < 4e-4
    ros = tmp_path / "motion.yaml"
    answer(seam, "--robot", "ur10", "--acceleration", "5", "--out", ros)
    content = yaml.safe_load(ros.read_text())
    assert content["joint_names"] == list(motion.joint_names)
    assert len(content["points"][0]["positions"]) == 6


def test_obstacles_are_kept_off_and_the_clearance_is_told(tmp_path: Path, seam: Path) -> None:
    scene = tmp_path / "lid.yaml"
    scene.write_text(LID)
    told = answer(seam, "--robot", "ur10", "--scene", scene, "--free", "z", "--clearance", "0.005")
    robot = pdoik.Robot.builtin("ur10")
    solver, shapes = pdoik.Solver(robot), pdoik.load_scene(scene)
    least = min(solver.judge(robot.fk(np.array(q)), q, shapes).clearance for q in told["q"])
    assert np.isclose(least, told["clearance"], atol=1e-6)
    assert least >= 0.005 - 1e-6
    points = tmp_path / "cloud.npy"
    np.save(points, np.array([[0.5, 0.0, 1.2], [0.5, 0.1, 1.2]]))
    assert answer(seam, "--robot", "ur10", "--scene", scene, "--cloud", points)["success"]


def test_a_path_out_of_reach_breaks_where_reach_ends_and_says_so(tmp_path: Path) -> None:
    long = table(tmp_path / "long.csv", np.linspace([0.6, 0.0, 0.3], [0.6, 1.6, 0.3], 100))
    told = answer(long, "--robot", "ur10", status=1)
    assert told["status"] == "impossible"
    (end, *_) = told["ends"]
    reach = 0.6**2 + (1.6 * end["at"] / 99) ** 2 + 0.3**2
    assert 1.0 < np.sqrt(reach) < 1.5
    assert told["unsolved"]
    assert told["unsolved"][0] <= end["at"] + 1
    out, picture = tmp_path / "part.csv", tmp_path / "part.png"
    outcome = run("path", long, "--robot", "ur10", "--out", out, "--picture", picture)
    assert outcome.exit_code == 1
    assert "breaks at station" in outcome.stdout
    assert "not the whole path" in outcome.stderr
    assert len(rows_of(out)[1]) > 20
    assert picture.read_bytes().startswith(b"\x89PNG")


def turning() -> np.ndarray:
    """Stations along which the tool turns thrice, more than the UR10's wrist, (N, 4, 4)."""
    angles = np.linspace(0.0, 6.0 * np.pi, 300)
    T = np.tile(np.eye(4), (300, 1, 1))
    T[:, :2, 0] = np.column_stack([np.cos(angles), np.sin(angles)])
    T[:, :2, 1] = np.column_stack([np.sin(angles), -np.cos(angles)])
    T[:, 2, 2], T[:, :3, 3] = -1.0, line(300, 0.3)
    return T


def test_what_cannot_be_one_motion_is_pieces_and_the_status_says_so(tmp_path: Path) -> None:
    turns = Rotation.from_matrix(turning()[:, :3, :3]).as_quat()
    rows = np.column_stack([line(300, 0.3), turns])
    file, out = tmp_path / "turns.csv", tmp_path / "rows.csv"
    np.savetxt(file, rows, delimiter=",", header="x,y,z,qx,qy,qz,qw", comments="")
    told = answer(file, "--robot", "ur10", "--out", out, status=3)
    assert told["status"] == "pieces"
    assert len(told["pieces"]) > 1
    assert len(told["moves"]) == len(told["pieces"]) - 1
    _, written = rows_of(out)
    assert {row[1] for row in written} >= {"0", "1"}
    lines = run("path", file, "--robot", "ur10").stdout
    assert "piece 1: from station 0.00" in lines
    assert "a clear move of" in lines
    assert run("path", file, "--robot", "ur10", "--no-reconfigure").exit_code == 1


def test_pieces_are_timed_with_the_moves_between_them(tmp_path: Path) -> None:
    pytest.importorskip("scipy")
    robot = pdoik.Robot.builtin("ur10")
    solver = pdoik.Solver(robot)
    result = solver.solve_path(turning())
    assert result.status == "pieces"
    assert all(len(move) for move in result.moves)
    tool = {"tool_speed": 0.1}
    motion, recheck = timed(robot, solver, result, None, {"max_acceleration": 5.0}, tool)
    assert recheck.success
    assert np.allclose(motion.q[0], result.q[0])
    assert np.allclose(motion.q[-1], result.q[-1])
    steps = np.abs(np.diff(motion.q, axis=0)) / np.diff(motion.time)[:, None]
    assert (steps <= robot.velocity * 1.001).all()
    for first, end in result.pieces:  # it comes by the ends of each piece, at rest
        for row in (first, end - 1):
            assert np.abs(motion.q - result.q[row]).max(axis=1).min() < 1e-6
    write_rows(tmp_path / "rows.csv", robot, result)
    written = rows_of(tmp_path / "rows.csv")[1]
    assert len(written) == len(result.q) + sum(len(move) - 2 for move in result.moves)


def test_a_cost_keeps_joints_off_their_limits(seam: Path) -> None:
    plain = answer(seam, "--robot", "panda")
    costly = answer(seam, "--robot", "panda", "--cost", "limits=5", "--cost", "motion=1")
    assert costly["success"]
    assert costly["limit_distance"] >= plain["limit_distance"] - 0.05


def test_a_picture_is_a_png(tmp_path: Path, seam: Path) -> None:
    pytest.importorskip("matplotlib")
    scene = tmp_path / "lid.yaml"
    scene.write_text(LID)
    picture = tmp_path / "path.png"
    run("path", seam, "--robot", "panda", "--scene", scene, "--free", "z", "--picture", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("is empty",)),
        ("x,y,z\n0,0,0\n0,0,1\n", ("line 1", "qx qy qz qw", "none of these")),
        ("x,y,qx,qy,qz,qw\n", ("line 1", "there is no z")),
        ("x,y,z,qx,qy,qz\n", ("line 1", "there is no qw")),
        ("x,y,z,z,ax,ay,az\n", ("line 1: column 4", "twice")),
        ("x,y,z,ax,ay,az,roll,pitch,yaw\n", ("line 1", "roll pitch yaw and ax ay az")),
        ("x,y,z,ax,ay,az\n0,0,0,0,0,1\n0,0,one,0,0,1\n", ("line 3: column 3 (z)", "'one'")),
        ("x,y,z,ax,ay,az\n\n0,0,0,0,0,1\n0,0,nan,0,0,1\n", ("line 4: column 3 (z)", "'nan'")),
        ("x,y,z,ax,ay,az\n0,0,0,0,0\n", ("line 2", "6 columns", "got 5")),
        ("x,y,z,ax,ay,az\n0,0,0,0,0,1\n0,0,1,0,0,0\n", ("line 3: columns ax to az", "direction")),
        ("x,y,z,qx,qy,qz,qw\n0,0,0,1,1,0,0\n0,0,1,1,0,0,0\n", ("line 2", "norm 1")),
        ("x,y,z,ax,ay,az\n0,0,0,0,0,1\n", ("at least two stations", "got 1")),
        ("x,y,z,ax,ay,az\n0,0,0,0,0,1\n0,0,0,0,0,1\n", ("the same one",)),
    ],
)
def test_a_table_that_is_none_is_refused_by_line_and_column(
    tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text)
    with pytest.raises(pdoik.LoadError) as error:
        read_path_file(file)
    assert str(error.value).startswith(str(file))
    for word in words:
        assert word in str(error.value)
    if "the same one" not in words:
        misuse(run("path", file, "--robot", "ur10"), *words)


def test_a_table_may_have_more_columns_a_mark_of_its_encoding_and_remarks(tmp_path: Path) -> None:
    file = tmp_path / "seam.csv"
    rows = [f"{k}, 0.5, {0.01 * k}, 0.3, 1, 0, 0, 0" for k in range(5)]
    text = "\n".join(["# by hand", "time, X, Y, Z, QX, QY, QZ, QW", *rows])
    file.write_bytes(b"\xef\xbb\xbf" + text.encode())
    read = read_path_file(file)
    assert read.poses is not None
    assert np.allclose(read.poses[:, 1, 3], 0.01 * np.arange(5))


def test_odd_rows_are_told(tmp_path: Path) -> None:
    again = table(tmp_path / "again.csv", np.repeat(line(10), 2, axis=0))
    outcome = run("path", again, "--robot", "ur10")
    assert outcome.exit_code == 0
    assert "repeats the row before: line 3, 5, 7" in outcome.stderr
    places = line(40)
    places[20:, 1] += 0.4
    outcome = run("path", table(tmp_path / "jump.csv", places), "--robot", "ur10")
    assert "from station 19 to 20" in outcome.stderr
    far = run("path", table(tmp_path / "mm.csv", 1e3 * line()), "--robot", "ur10")
    assert far.exit_code == 1
    assert "millimetres" in far.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--speed", "0.1"), ("--speed", "--acceleration")),
        (("--out", "motion.yaml"), ("--out", "--acceleration")),
        (("--out", "motion.txt"), ("--out", ".csv")),
        (("--picture", "a.jpg"), ("--picture", ".png")),
        (("--cost", "speed=1"), ("--cost", "limits")),
        (("--cost", "limits=-1"), ("--cost", "limits=-1")),
        (("--start", "0 0"), ("--start", "6 numbers")),
        (("--start", "0 0 0 0 0 0"), ("start",)),
        (("--lock", "elbow=1"), ("--lock", "elbow_joint")),
        (("--spacing", "0"), ("spacing",)),
        (("--max-time", "0"), ("--max-time", "positive")),
        (("--acceleration", "1 2"), ("--acceleration", "6")),
        (("--tool", "0 0"), ("--tool",)),
        (("--scene", "none.yaml"), ("none.yaml",)),
    ],
)
def test_misuse_is_told(seam: Path, arguments: tuple[str, ...], words: tuple[str, ...]) -> None:
    misuse(run("path", seam, "--robot", "ur10", *arguments), *words)


def test_files_that_are_not_there_or_of_no_kind_are_refused(tmp_path: Path) -> None:
    misuse(run("path", tmp_path / "none.csv", "--robot", "ur10"), "no such file")
    misuse(run("path", tmp_path / "path.stl", "--robot", "ur10"), ".csv, .yaml")
    file = tmp_path / "bad.yaml"
    file.write_text("- {pose: {xyz: [1, 2]}}\n- [\n")
    misuse(run("path", file, "--robot", "ur10"), "line")
    file.write_text("- {pose: {xyz: [1, 2, 3], rpy: [0, 0]}}\n- []\n")
    misuse(run("path", file, "--robot", "ur10"), "line 1: goals[0].pose.rpy")


def test_a_search_goes_on_for_longer_only_where_time_was_short() -> None:
    class Told:
        def __init__(self, success: bool, time: float) -> None:
            self.success, self.time = success, time

    asked: list[float] = []

    def ask(success: bool, share: float) -> Any:
        def once(seconds: float) -> Any:
            asked.append(seconds)
            return Told(success, share * seconds)

        return once

    search(ask(True, 1.0), "a path", 60.0)
    assert asked == [2.0]
    asked.clear()
    search(ask(False, 1.0), "a path", 60.0)
    assert asked[:3] == [2.0, 4.0, 8.0]
    assert np.isclose(sum(asked), 60.0)
    asked.clear()
    search(ask(False, 0.1), "a path", 60.0)
    assert asked == [2.0]

    def fails(seconds: float) -> Any:
        raise ValueError("no path")

    with pytest.raises(ValueError, match="no path"):
        search(fails, "a path", 5.0)


def test_ctrl_c_ends_a_search_at_once_with_what_is_known(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pdoik.cli.path_search import search\n"
        "class Told: success, time = False, 2.0\n"
        "def ask(seconds):\n"
        "    if seconds > 2.0: print('again', flush=True); time.sleep(60)\n"
        "    return Told()\n"
        "found = search(ask, 'a path', 60.0)\n"
        "print(found.is_stopped, found.result is not None, flush=True)\n"
        "from pdoik.cli.interrupts import leave; leave(130)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, cwd=tmp_path
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "again\n"
        os.kill(process.pid, signal.SIGINT)
        assert process.stdout.readline() == "True True\n"
        assert process.wait(30) == 130
