"""Misuse of the command line: status 2, one line that names the thing, no half-written file."""

from pathlib import Path

import numpy as np
import pytest

from command_line import REACHABLE, misuse, run, solve


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("1 2", ["--target", "2 numbers"]),
        ("a b c", ["--target", "'a b c'"]),
        ("", ["--target"]),
        ("0.4 0 nan 0 0 0 1", ["--target", "finite"]),
        ("0.4 0 0.5", ["--target", "--goal position"]),
        ("0.4 0 0.5 0 0 0 0", ["--target", "norm 0"]),
        ("0.4 0 0.5 1 1 0 0", ["--target", "norm 1.414"]),
        ("none.npy", ["--target", "none.npy", "no such file"]),
    ],
)
def test_a_bad_target_is_misuse(target: str, words: list[str]) -> None:
    misuse(solve(target=target), *words)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("t.json", "{", ["4x4"]),
        ("t.json", "[[1, 2], [3]]", ["4x4"]),
        ("t.json", '{"T": 1}', ["4x4"]),
        ("t.txt", "1 2 3\n4 5 6\n", ["(2, 3)"]),
        ("t.txt", "1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n", ["determinant -1"]),
        ("t.txt", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", ["determinant 2"]),
        ("t.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0.4 0 0.5 1\n", ["last row"]),
        ("t.npy", "garbage", ["t.npy"]),
        ("t.npy", "", ["t.npy"]),
    ],
)
def test_a_bad_target_file_is_misuse(
    tmp_path: Path, name: str, content: str, words: list[str]
) -> None:
    path = tmp_path / name
    path.write_text(content)
    misuse(solve(target=path), str(path), *words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--q0", "1 2 3"], ["--q0", "7", "3"]),
        (["--q0", "a b"], ["--q0", "'a b'"]),
        (["--q0", "nan 0 0 -1 0 1 0"], ["q0"]),
        (["--cloud", "none.pcd"], ["none.pcd", "no such file"]),
        (["--max-time", "-1"], ["max_time"]),
        (["--position-tolerance", "0"], ["position_tolerance"]),
        (["--seed", "-1"], ["seed"]),
        (["--base-link", "a"], ["link", "'a'"]),
        (["--occupancy", "none.yaml"], ["none.yaml"]),
        (["--picture", "out.bmp"], ["--picture", ".png"]),
        (["--picture", "no/such/folder/out.png"], ["--picture", "no/such/folder"]),
    ],
)
def test_a_bad_option_is_misuse(arguments: list[str], words: list[str]) -> None:
    misuse(solve(*arguments), *words)


@pytest.mark.parametrize("leaf", ["-0.1", "nan", "inf"])
def test_a_bad_leaf_is_misuse(tmp_path: Path, leaf: str) -> None:
    np.save(tmp_path / "cloud.npy", np.ones((9, 3)))
    misuse(solve("--cloud", tmp_path / "cloud.npy", "--leaf", leaf), "leaf")


@pytest.mark.parametrize("suffix", ["pcd", "ply", "npy", "xyz", "urdf", "yaml"])
def test_garbage_files_are_misuse_and_leave_nothing_behind(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"garbage.{suffix}"
    path.write_bytes(bytes(range(256)) * 20)
    picture = tmp_path / "out.png"
    if suffix == "urdf":
        outcome = run("solve", "--robot", path, "--target", REACHABLE, "--picture", picture)
    elif suffix == "yaml":
        outcome = solve("--occupancy", path, "--picture", picture)
    else:
        outcome = solve("--cloud", path, "--picture", picture)
    misuse(outcome, "garbage")
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_an_unknown_robot_is_told_the_names() -> None:
    misuse(run("solve", "--robot", "pandas", "--target", REACHABLE), "panda, ur10", "'pandas'")
    misuse(run("info", "pandas"), "panda")


@pytest.mark.parametrize("arguments", [[], ["--robot", "panda"], ["--target", REACHABLE]])
def test_a_missing_option_is_misuse(arguments: list[str]) -> None:
    assert run("solve", *arguments).exit_code == 2


def test_unknown_commands_options_and_goals_are_misuse() -> None:
    assert run("solved").exit_code == 2
    assert solve("--golly").exit_code == 2
    assert solve("--goal", "moon").exit_code == 2
    assert solve("--leaf", "small").exit_code == 2
