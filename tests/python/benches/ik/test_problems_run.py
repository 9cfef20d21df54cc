"""The problem sets' command, in small: made, solved, judged, and what failed drawn."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("coal")
pytest.importorskip("pinocchio")

from bench.ik.problems.judge import Judge
from bench.ik.problems.robots import robot_files
from problem_sets import READY, collision_object, request, write_moveit

REPOSITORY = Path(__file__).parents[4]


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "bench.ik.problems", *map(str, arguments)]
    return subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)


def problems(*arguments: str | Path) -> str:
    done = run(*arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_sets_are_solved_and_judged_and_failures_drawn(tmp_path: Path) -> None:
    sets, budgets = ("box", "flat_table"), ("--budget", "50", "--budget", "0.0001")
    table = problems(
        *("run", *sets, "--robot", "panda", "--count", "3", "--method", "shapes"),
        *(*budgets, "--out", tmp_path),
    )
    (results,) = tmp_path.glob("*.json")
    rows = json.loads(results.read_text())["rows"]
    assert [(row["set"], row["budget"]) for row in rows] == [
        (name, budget) for name in sets for budget in (50.0, 0.0001)
    ]
    for row in rows:
        assert row["total"] == row["ceiling"] == 3
        assert row["wrong"] == 0
        assert row["solved"] + row["none"] == 3
        assert f"| {row['set']} | panda | shapes | {row['budget']:g} |" in table
    assert all(row["solved"] == 3 for row in rows if row["budget"] == 50.0)
    assert any(row["none"] for row in rows)  # no time to find anything
    picture = tmp_path / "failed.png"
    assert "problems drawn" in problems("draw", "--failed", results, "--out", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert picture.stat().st_size > 20_000


def test_a_set_says_how_far_the_hand_is_open_and_the_user_says_better(tmp_path: Path) -> None:
    judge = Judge(robot_files("panda"), "collision")
    T = judge.fk(np.array(READY), "panda_hand_tcp")
    bar = collision_object("bar", "box", [0.02, 0.1, 0.02], T[:3, 3].tolist())  # between fingers
    xyzw = Rotation.from_matrix(T[:3, :3]).as_quat().tolist()
    bar["primitive_poses"][0]["orientation"] = xyzw
    folder = tmp_path / "grasp_panda"
    for number, opening in enumerate((0.065, 0.065, 0.07), 1):
        asked = request()
        fingers = {"panda_finger_joint1": opening, "panda_finger_joint2": opening}
        state = asked["start_state"]["joint_state"]
        state["name"], state["position"] = (
            [*state["name"], *fingers],
            [*state["position"], *fingers.values()],
        )
        write_moveit(folder, {"world": {"collision_objects": [bar]}}, asked, number)
    asked_for = ("run", "--from", folder, "--robot", "panda", "--budget", "200")

    told = problems(*asked_for, "--meshes", "collision", "--out", tmp_path / "open")
    assert "held as the set says: panda_finger_joint1=0.065, panda_finger_joint2=0.065" in told
    assert "panda_finger_joint1=0.07" in told
    (results,) = (tmp_path / "open").glob("*.json")
    (row,) = json.loads(results.read_text())["rows"]
    assert (row["total"], row["ceiling"], row["solved"], row["wrong"]) == (3, 3, 3, 0)
    assert [trial["problem"][-4:] for trial in row["trials"]] == ["0001", "0002", "0003"]

    closed = ("--hold", "panda_finger_joint1=0.04", "--hold", "panda_finger_joint2=0.04")
    told = problems(*asked_for, *closed, "--meshes", "collision", "--out", tmp_path / "closed")
    assert "held as the set says" not in told
    (results,) = (tmp_path / "closed").glob("*.json")
    (row,) = json.loads(results.read_text())["rows"]
    assert (row["total"], row["ceiling"]) == (3, 0)  # what the set calls valid is in the bar


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--hold", "panda_finger_joint3=0.02"), "no joint 'panda_finger_joint3' to hold"),
        (("--hold", "panda_finger_joint1"), "expected JOINT=VALUE"),
        (("--tip", "panda_hand"), "--tip is for a robot of one's own: give --urdf, too"),
    ],
)
def test_options_that_cannot_be_are_refused(options: tuple[str, ...], says: str) -> None:
    done = run("run", "box", "--robot", "panda", "--count", "1", *options)
    assert done.returncode != 0
    assert says in " ".join((done.stdout + done.stderr).replace("│", " ").split())
