"""The command line: exit status, tables, JSON, files, and what bad input gets."""

import importlib.util
import json
import math
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from PIL import Image
from scipy.spatial.transform import Rotation

import pdoik
from command_line import PANDA, REACHABLE, misuse, run, solve
from pdoik.cli.tables import angle_text, json_text, length_text, time_text
from pdoik.cli.target import parse_target


@pytest.fixture
def wall(tmp_path: Path) -> Path:
    """A wall that the arm can reach its target beside."""
    y, z = np.meshgrid(np.linspace(-0.6, 0.6, 60), np.linspace(0.0, 1.0, 50))
    points = np.column_stack([np.full(y.size, -0.45), y.ravel(), z.ravel()])
    path = tmp_path / "wall.npy"
    np.save(path, points)
    return path


def test_a_reachable_target_is_solved() -> None:
    outcome = solve()
    assert outcome.exit_code == 0
    assert outcome.stdout.startswith("solved")
    for name in pdoik.Robot.builtin("panda").joint_names:
        assert name in outcome.stdout
    assert max(len(line) for line in outcome.stdout.splitlines()) <= 80


def test_a_target_out_of_reach_is_not_solved_and_says_what_to_try() -> None:
    outcome = solve(target="3 0 0.5 1 0 0 0")
    assert outcome.exit_code == 1
    assert outcome.stdout.startswith("not solved")
    assert "try a target nearer" in outcome.stdout


def test_a_target_in_an_obstacle_is_blocked_and_says_what_touches(tmp_path: Path) -> None:
    cloud = tmp_path / "crate.xyz"
    q = [0.3, 0.2, 0.0, -1.8, 0.0, 2.2, 0.8]
    T = pdoik.Robot.builtin("panda").fk(q)
    cloud.write_text(" ".join(f"{x:.6f}" for x in T[:3, 3] - 0.05 * T[:3, 2]) + "\n")
    x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat()
    target = " ".join(f"{v:.6f}" for v in (*T[:3, 3], w, x, y, z))
    outcome = solve("--cloud", cloud, target=target)
    assert outcome.exit_code == 1
    assert outcome.stdout.startswith("not solved: every start ends in the same obstacle")
    assert "to obstacle 0" in outcome.stdout
    assert "try another target" in outcome.stdout


def test_links_are_kept_off_each_other_where_the_pairs_are_known(tmp_path: Path) -> None:
    # The hand would have to go through the arm's own foot.
    inside = "0.0 0.0 0.12 1 0 0 0"

    kept = solve("--goal", "position", target=inside)
    assert kept.exit_code == 1
    assert "panda_link0" in kept.stdout
    assert "--no-self-collision" in kept.stdout
    assert "between links" in kept.stdout
    assert solve("--goal", "position", "--no-self-collision", target=inside).exit_code == 0
    srdf = tmp_path / "all.srdf"
    names = pdoik.Robot.builtin("panda").link_names
    pairs = [f'<disable_collisions link1="{a}" link2="{b}"/>' for a in names for b in names]
    srdf.write_text(f'<robot name="panda">{"".join(pairs)}</robot>')
    assert solve("--goal", "position", "--srdf", srdf, target=inside).exit_code == 0
    misuse(solve("--srdf", tmp_path / "none.srdf"), "--srdf", "none.srdf")


def test_json_holds_the_whole_result(wall: Path) -> None:
    outcome = solve("--json", "--cloud", wall, "--leaf", "0.05")
    assert outcome.exit_code == 0
    content = json.loads(outcome.stdout, parse_constant=pytest.fail)
    robot = pdoik.Robot.builtin("panda")
    assert content["joint_names"] == robot.joint_names
    assert content["status"] == "solved"
    assert content["success"] is True
    T = robot.fk(content["q"])
    np.testing.assert_allclose(T, content["T_base_tip"], atol=3e-5)
    assert content["position_error"] <= 1e-5
    assert content["cloud"]["points"] == 3000
    assert 0 < content["cloud"]["obstacles"] < 3000
    fields = {name for name in dir(pdoik.Result) if not name.startswith("_")}
    assert fields <= set(content), fields - set(content)


def test_json_has_null_for_infinity() -> None:
    outcome = solve("--json")
    assert json.loads(outcome.stdout, parse_constant=pytest.fail)["clearance"] is None


def test_json_of_a_failure_is_json_too() -> None:
    outcome = solve("--json", target="3 0 0.5 1 0 0 0")
    assert outcome.exit_code == 1
    assert json.loads(outcome.stdout, parse_constant=pytest.fail)["success"] is False


def test_the_same_command_gives_the_same_answer(wall: Path) -> None:
    first, again = (json.loads(solve("--json", "--cloud", wall).stdout) for _ in range(2))
    assert first["q"] == again["q"]


@pytest.mark.parametrize("suffix", [".npy", ".json", ".txt"])
def test_a_target_may_be_a_file(tmp_path: Path, suffix: str) -> None:
    T = pdoik.Robot.builtin("panda").fk(np.array([0.1, -0.4, 0.2, -2.0, 0.3, 1.8, 0.5]))
    path = tmp_path / f"target{suffix}"
    if suffix == ".npy":
        np.save(path, T)
    elif suffix == ".json":
        path.write_text(json.dumps(T.tolist()))
    else:
        np.savetxt(path, T, fmt="%.5f")
    outcome = solve("--json", target=path)
    assert outcome.exit_code == 0, outcome.output
    np.testing.assert_allclose(json.loads(outcome.stdout)["T_base_tip"], T, atol=1e-5)


def test_quaternion_and_roll_pitch_yaw_agree() -> None:
    half = 0.35
    by_quaternion = parse_target(f"1 2 3 0 0 {math.sin(half)} {math.cos(half)}", "pose")
    np.testing.assert_allclose(
        by_quaternion, parse_target("1, 2, 3, 0, 0, 0.7", "pose"), atol=1e-15
    )
    T = parse_target("0 0 0 0.1 -0.2 0.3", "pose")
    cx, sx, cy, sy, cz, sz = (f(angle) for angle in (0.1, -0.2, 0.3) for f in (math.cos, math.sin))
    Rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    Ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    Rz = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    np.testing.assert_allclose(T[:3, :3], Rz @ Ry @ Rx, atol=1e-15)


def test_a_scene_counts_alone_and_together_with_a_cloud(tmp_path: Path, wall: Path) -> None:
    free = json.loads(solve("--json").stdout)
    x, y, z = np.array(free["T_base_tip"])[:3, 3]
    (tmp_path / "behind.xyz").write_text(f"{x} {y} {z + 0.6}\n")
    scene = tmp_path / "scene.yaml"
    ball = f"{{name: ball, sphere: 0.1, position: [{x}, {y}, {z - 0.22}]}}"
    scene.write_text(f"shapes: [{ball}]\ncloud: behind.xyz\nallowed: [[panda_link7, ball]]\n")
    alone = json.loads(solve("--json", "--scene", scene).stdout)
    assert alone["scene"] == {"file": str(scene), "shapes": ["ball"], "points": 1}
    judge = pdoik.Solver(pdoik.Robot.builtin("panda")).judge
    T, q = np.array(alone["T_base_tip"]), alone["q"]
    obstacles = pdoik.load_scene(scene)
    assert alone["clearance"] == pytest.approx(judge(T, q, obstacles=obstacles).clearance)
    assert alone["clearance"] < judge(T, q, obstacles=obstacles.cloud).clearance
    both = json.loads(solve("--json", "--scene", scene, "--cloud", wall, "--leaf", "0").stdout)
    assert both["cloud"]["points"] == 3001
    each = [judge(T, both["q"], obstacles=part).clearance for part in (obstacles, np.load(wall))]
    assert both["clearance"] == pytest.approx(min(each))
    report = solve("--scene", scene, "--cloud", wall).stdout
    assert "points and 1 shape," in " ".join(report.split())

    scene.write_text(f"shapes: [{ball}]\nallowed: [[nobody, ball]]\n")
    misuse(solve("--scene", scene), "nobody")
    scene.write_text("shapes: [{name: ball}]")
    misuse(solve("--scene", scene), "scene.yaml", "(ball)")


def test_goals_that_ask_for_less_are_met() -> None:
    assert solve("--goal", "position", target="0.4 0.1 0.5").exit_code == 0
    outcome = solve("--goal", "axis", "--goal-axis", "x", "--json")
    assert outcome.exit_code == 0
    R = pdoik.Robot.builtin("panda").fk(json.loads(outcome.stdout)["q"])[:3, :3]
    np.testing.assert_allclose(R[:, 0], [1, 0, 0], atol=2e-5)


def test_the_start_decides_where_the_answer_is() -> None:
    q0 = np.array([0.5, -0.3, 0.4, -1.9, 0.2, 1.7, 0.1])
    T = pdoik.Robot.builtin("panda").fk(q0)
    words = " ".join(repr(float(value)) for value in T[:3, 3])
    outcome = solve("--q0", " ".join(map(str, q0)), "--goal", "position", "--json", target=words)
    np.testing.assert_allclose(json.loads(outcome.stdout)["q"], q0, atol=1e-4)


def test_points_that_thinning_left_out_are_warned_of(tmp_path: Path) -> None:
    solved = json.loads(solve("--json").stdout)
    in_flange = (np.array(solved["T_base_tip"]) @ [0.0, 0.0, -0.05, 1.0])[:3]
    # Two points of one cell, one of them inside the arm, the mean far from it.
    points = tmp_path / "pair.npy"
    np.save(points, np.array([in_flange, [5.9, 5.9, 5.9]]))
    outcome = solve("--cloud", points, "--leaf", "6", "--no-radii")
    assert outcome.exit_code == 0
    assert "warning:" in outcome.stderr
    assert "--leaf 6" in outcome.stderr


def test_an_obstacle_in_the_base_is_told_apart(tmp_path: Path) -> None:
    cloud = tmp_path / "base.xyz"
    cloud.write_text("0 0 0.1\n")
    outcome = solve("--cloud", cloud)
    assert outcome.exit_code == 1
    assert "no joint moves" in outcome.stdout
    assert "the robot's own points" in outcome.stdout.replace("\n", " ")


def test_a_picture_is_a_png(tmp_path: Path, wall: Path) -> None:
    path = tmp_path / "out.png"
    assert solve("--cloud", wall, "--picture", path).exit_code == 0
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    assert len(content) > 50_000
    assert {entry.name for entry in tmp_path.iterdir()} == {"out.png", "wall.npy"}


def test_a_picture_shows_the_shapes_of_a_scene_and_needs_no_single_target(tmp_path: Path) -> None:
    scene, goals, path = (tmp_path / name for name in ("scene.yaml", "goals.yaml", "out.png"))
    T = np.eye(4)
    T[:3, 3] = -0.5, -0.5, 0.2
    pdoik.save_scene(pdoik.Scene([pdoik.Shape.box("box", (0.3, 0.3, 0.3), T)]), scene)
    goals.write_text(
        "- {position: [-0.4, 0.1, 0.5]}\n- {look_at: {point: [0, 0, 2]}, soft: true}\n"
    )
    for goal in (["--target", REACHABLE], ["--goals", goals]):
        outcome = run("solve", "panda", *goal, "--scene", scene, "--picture", path)
        assert outcome.exit_code == 0, outcome.output
        assert not outcome.stderr
        image = imread(path)[..., :3]
        tan = (image[..., 0] - image[..., 2] > 0.2) & (image[..., 1] - image[..., 2] > 0.1)
        assert tan.mean() > 0.005
        path.unlink()


@pytest.mark.parametrize("command", ["solve", "info", "occupancy", "bench"])
def test_every_command_has_help_with_an_example(command: str) -> None:
    outcome = run(command, "--help")
    assert outcome.exit_code == 0
    assert f"Example: pdoik {command}" in outcome.stdout
    assert "[m]" not in outcome.stdout


def test_the_version_is_the_packages() -> None:
    assert run("--version").stdout.strip() == pdoik.__version__


@pytest.mark.parametrize("name", ["panda", "ur10", "iiwa14"])
def test_info_shows_joints_limits_and_hulls(name: str) -> None:
    outcome = run("info", name)
    assert outcome.exit_code == 0
    robot = pdoik.Robot.builtin(name)
    for joint in robot.joint_names:
        assert joint in outcome.stdout
    facts = json.loads(run("info", name, "--json").stdout)
    assert facts["lower"] == robot.lower.tolist()
    assert facts["spheroids"] == len(robot.occupancy.spheroids)


def test_bench_counts_what_it_solved() -> None:
    outcome = run(
        "bench", "--robot", "panda", "--targets", "20", "--obstacles", "30", "--max-time", "1"
    )
    assert outcome.exit_code == 0
    rows = [line.split() for line in outcome.stdout.splitlines() if line.split()[:1] == ["panda"]]
    assert [row[1] for row in rows] == ["0", "30"]
    for row in rows:
        assert row[3:5] == ["/", "20"]
        assert int(row[2]) >= 19


URDF = """<robot name="planar">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="upper"><collision>
    <origin xyz="0.25 0 0"/><geometry><box size="0.5 0.1 0.1"/></geometry></collision></link>
  <link name="fore"><collision>
    <origin xyz="0.2 0 0"/><geometry><box size="0.4 0.08 0.08"/></geometry></collision></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tool"/>
    <origin xyz="0.4 0 0"/></joint>
</robot>"""


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    path = tmp_path / "planar.urdf"
    path.write_text(URDF)
    return path


def test_a_urdf_goes_from_geometry_to_a_solution_clear_of_a_cloud(
    tmp_path: Path, urdf: Path
) -> None:
    hulls = tmp_path / "planar.yaml"
    outcome = run("occupancy", urdf, "--max-parts", "1", "--out", hulls)
    assert outcome.exit_code == 0, outcome.output
    assert "upper" in outcome.stdout
    cloud = tmp_path / "cloud.xyz"
    cloud.write_text("0.55 -0.35 0\n")
    arguments = ["solve", "--robot", urdf, "--goal", "position", "--target", "0.6 0.3 0"]
    misuse(run(*arguments, "--cloud", cloud), "planar", "--occupancy")
    outcome = run(*arguments, "--cloud", cloud, "--occupancy", hulls, "--max-time", "1", "--json")
    assert outcome.exit_code == 0, outcome.output
    assert json.loads(outcome.stdout)["clearance"] > 0
    assert json.loads(run("info", urdf, "--occupancy", hulls, "--json").stdout)["spheroids"] > 0


def test_occupancy_warns_of_links_that_too_few_capsules_hold(
    urdf: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pdoik.occupancy_fit.capsules._MOST", 1)
    outcome = run("occupancy", urdf, "--max-parts", "1", "--processes", "1")
    assert outcome.exit_code == 0, outcome.output
    assert "warning: upper: capsules stick out" in " ".join(outcome.stderr.split())


def test_occupancy_tells_of_each_link_and_of_those_left_out(tmp_path: Path, urdf: Path) -> None:
    arguments = ["--max-parts", "1", "--no-capsules", "--tip-link", "upper", "--cache", tmp_path]
    outcome = run("occupancy", urdf, *arguments)
    assert outcome.exit_code == 0, outcome.output
    lines = outcome.stderr.splitlines()
    told = [line.partition(": ")[2] for line in lines if line.startswith(("base:", "upper:"))]
    assert [line.partition(" s; ")[0][:10] for line in told] == ["fitted in "] * 2
    assert [line.partition("; ")[2][:12] for line in told] == ["1 of 2 links", "2 of 2 links"]
    assert "about" in told[0]
    assert any(line.startswith("warning: left out") and "fore" in line for line in lines)
    again = run("occupancy", urdf, *arguments)
    assert again.stderr.count("kept from an earlier fit") == 2
    assert again.stdout == outcome.stdout
    misuse(run("occupancy", urdf, *arguments, "--no-cache"), "--cache", "--no-cache")


def test_occupancy_draws_where_capsules_stick_out_most(tmp_path: Path, urdf: Path) -> None:
    picture = tmp_path / "out.png"
    outcome = run("occupancy", urdf, "--tip-link", "base", "--picture", picture)
    assert outcome.exit_code == 0, outcome.output
    with Image.open(picture) as image:
        colors = {color for _, color in image.convert("RGB").getcolors(1 << 24)}
    assert (211, 21, 27) in colors  # the mark
    misuse(run("occupancy", urdf, "--paper", "--picture", picture), "--picture")
    misuse(run("occupancy", urdf, "--picture", tmp_path / "out.jpg"), "--picture", ".png")


def test_occupancy_refuses_what_it_cannot_fit(tmp_path: Path, urdf: Path) -> None:
    misuse(run("occupancy", tmp_path / "none.urdf"), "none.urdf")
    misuse(run("occupancy", urdf, "--out", tmp_path / "no" / "a.yaml"), "--out")
    misuse(run("occupancy", urdf, "--max-volume-factor", "0.5"), "max_volume_factor", "0.5")
    bare = tmp_path / "bare.urdf"
    bare.write_text('<robot name="bare"><link name="base"/></robot>')
    out = tmp_path / "bare.yaml"
    misuse(run("occupancy", bare, "--out", out), "collision geometry")
    assert not out.exists()


def test_the_table_of_the_commands_page_is_that_of_the_commands() -> None:
    docs = Path(__file__).parents[3] / "python" / "docs"
    spec = importlib.util.spec_from_file_location("command_table", docs / "command_table.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    text = module.PAGE.read_text(encoding="utf-8")
    assert text == module.page(text), "python python/docs/command_table.py writes it anew"


def test_earlier_names_still_work() -> None:
    target = ("--target", REACHABLE, "--max-time", "1", "--json")
    answers = [run("solve", *robot, *target) for robot in (("panda",), ("--robot", "panda"))]
    first, second = (json.loads(each.stdout)["q"] for each in answers)
    assert first == second
    assert "pdoik simulate" in run("replay", "--help").stdout
    misuse(run("solve", "panda", "--robot", "ur10", *target), "--robot ur10")
    misuse(run("solve", *target), "no robot")


def test_nothing_asked_for_is_told_what_to_do_first() -> None:
    outcome = run()
    assert outcome.exit_code == 0
    told = [line.partition("pdoik ")[2].split() for line in outcome.stdout.splitlines()]
    commands = [words[0] for words in told if words and not words[0].startswith(("-", "COMMAND"))]
    assert commands == ["view", "solve", "info", "occupancy", "study", "view"]
    for command in commands:
        assert run(command, "--help").exit_code == 0


def test_numbers_read_well() -> None:
    assert length_text(1.2345) == "1.234 m"
    assert length_text(0.0123) == "12.30 mm"
    assert length_text(3.2e-6) == "3.2 µm"
    assert length_text(math.inf) == "-"
    assert angle_text(0.5) == "0.5000 rad (28.65°)"
    assert time_text(4.2e-5) == "42 µs"
    assert time_text(0.0123) == "12.30 ms"
    text = json_text({"a": np.array([1.0, np.nan]), "b": (np.float64("-inf"), {"c": np.int64(3)})})
    assert json.loads(text) == {"a": [1.0, None], "b": [None, {"c": 3}]}


def test_the_package_is_the_command_for_python_m() -> None:
    said = {
        module: subprocess.run(
            [sys.executable, "-m", module, "info", "panda"], capture_output=True, text=True
        )
        for module in ("pdoik", "pdoik.cli")
    }
    assert said["pdoik"].returncode == 0, said["pdoik"].stderr
    assert said["pdoik"].stdout == said["pdoik.cli"].stdout


def test_the_entry_point_runs_the_app(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (entry,) = entry_points(group="console_scripts", name="pdoik")
    monkeypatch.setattr("sys.argv", ["pdoik", "info", "panda"])
    monkeypatch.setattr("pdoik.cli.interrupts.take_over", lambda: None)  # of this process's signals
    with pytest.raises(SystemExit) as left:
        entry.load()()
    assert left.value.code == 0
    assert "panda_joint1" in capsys.readouterr().out


@pytest.mark.parametrize(("target", "status"), [(REACHABLE, 0), ("9 9 9 1 0 0 0", 1), ("9", 2)])
def test_a_process_leaves_with_the_status(target: str, status: int) -> None:
    command = [sys.executable, "-m", "pdoik.cli", "solve", *PANDA, "--target", target]
    outcome = subprocess.run([*command, "--json"], capture_output=True, text=True, check=False)
    assert outcome.returncode == status, outcome.stderr
    if status == 2:
        assert outcome.stdout == ""
        assert outcome.stderr.count("\n") == 1
    else:
        assert json.loads(outcome.stdout)["success"] is (status == 0)
