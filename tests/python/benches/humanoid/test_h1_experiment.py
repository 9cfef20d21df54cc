"""The H1 that dodges: small experiments, going on after a stop, misuse, logs, pictures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from command_line import misuse

mujoco = pytest.importorskip("mujoco", reason="needs the Python package mujoco")

pytest.importorskip("pinocchio", reason="needs the Python package pin")

import pdoik  # noqa: E402
from bench.humanoid.__main__ import app  # noqa: E402
from bench.humanoid.dodge.plan import Plan  # noqa: E402
from bench.humanoid.report.foreseen import cause, dodgeable, dodged  # noqa: E402
from bench.humanoid.report.report import write_report  # noqa: E402
from bench.humanoid.trials.checks import (  # noqa: E402
    PinocchioKinematics,
    check_answers,
    self_pairs,
)
from bench.humanoid.trials.draw_throws import control_run  # noqa: E402
from bench.humanoid.trials.experiment import (  # noqa: E402
    PAPER_THROWS,
    Experiment,
    Job,
    settings_for,
)
from bench.humanoid.trials.measures import beyond_box, first_saturated, run_measures  # noqa: E402
from bench.humanoid.trials.store import (  # noqa: E402
    Store,
    plain,
    plan_of,
    plan_record,
    throw_of,
    throw_record,
)
from bench.humanoid.world.log import OBJECT, log_columns, object_in_pelvis, write_log  # noqa: E402
from bench.humanoid.world.model import body_pose, build_world  # noqa: E402
from bench.humanoid.world.objects import OBJECT_NAMES, load_object  # noqa: E402
from bench.humanoid.world.robot import FREE, PAPER, WELDED  # noqa: E402
from bench.humanoid.world.simulate import Push, hold, simulate  # noqa: E402
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER, standing_posture  # noqa: E402
from bench.humanoid.world.throws import Throw  # noqa: E402
from pdoik.view.h1_shapes import JOINT_NAMES  # noqa: E402

REPOSITORY = Path(__file__).parents[4]
THROW = Throw(object_name=OBJECT_NAMES[0], aim=(0.0, 0.0, 1.2), start=(0.3, -2.4, 1.5), speed=3.0)


def h1(*arguments: str | Path) -> Any:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One quick experiment with primitives."""
    folder = tmp_path_factory.mktemp("h1") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("PDOIK_SHARED", raising=False)
        invocation = h1("--quick", "--setup", "welded", "--out", folder)
    assert invocation.exit_code == 0, invocation.output
    assert "primitives" in invocation.stdout
    assert str(folder / "report.md") in invocation.stdout
    return folder


def records(folder: Path, mode: str) -> list[dict[str, Any]]:
    return [
        json.loads(path.read_text()) for path in sorted((folder / "results").glob(f"{mode}_*.json"))
    ]


def test_a_quick_experiment_runs_all_its_trials(finished: Path) -> None:
    names = {path.stem for path in (finished / "results").iterdir()}
    throws = range(3)
    assert names == {
        "stand_welded",
        *(f"predict_welded_{k:03d}" for k in throws),
        *(f"react_welded_{k:03d}_2" for k in throws),
    }
    assert not list(finished.rglob(".*"))
    report = (finished / "report.md").read_text()
    for words in ("7 of 7 trials", "primitives", "Standing", "Foreseen", "not foreseen", "p99.9"):
        assert words in report
    content = json.loads((finished / "report.json").read_text())
    assert set(content["trials"]) == names
    assert content["latency"]["react, welded"]["steps"] > 1000


def test_every_throw_hits_a_robot_that_stands_still(finished: Path) -> None:
    for record in records(finished, "predict") + records(finished, "react"):
        assert record["standing_still"] is not None


def test_answers_hold_what_they_claim_by_other_libraries(finished: Path) -> None:
    """The right foot by Pinocchio on the URDF, the steps by the limits, whatever came of it."""
    followed = [record for record in records(finished, "predict") if "run" in record]
    assert followed
    for record in followed:
        own, judged = record["answers"], record["checks"]
        assert judged["position_error"] == pytest.approx(own["position_error"], abs=1e-6)
        assert judged["rotation_error"] == pytest.approx(own["rotation_error"], abs=1e-6)
        assert max(judged["com_beyond_box"]) <= own["balance_violation"] + 1e-6
        assert own["largest_jump"] <= 1 + 1e-9
        assert own["rate"][0] <= own["rate"][1] <= own["rate"][2]


def test_an_experiment_goes_on_where_it_was(finished: Path, tmp_path: Path) -> None:
    """Results are read, not made again; what is missing is made."""
    folder = tmp_path / "out"
    (folder / "results").mkdir(parents=True)
    for name in ("settings.json", "results/stand_welded.json"):
        (folder / name).write_bytes((finished / name).read_bytes())
    marked = json.loads((folder / "results/stand_welded.json").read_text()) | {"seconds": 12345}
    (folder / "results/stand_welded.json").write_text(json.dumps(marked))
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("PDOIK_SHARED", raising=False)
        again = h1("--quick", "--mode", "stand", "--setup", "welded", "--out", folder)
        more = h1("--quick", "--mode", "stand", "--setup", "free", "--out", folder)
    assert again.exit_code == more.exit_code == 0, more.output
    assert json.loads((folder / "results/stand_welded.json").read_text())["seconds"] == 12345
    assert (folder / "results/stand_free.json").exists()
    assert "1 of 1 trials" in (folder / "report.md").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--seed", "7"], ["holds results with seed = 0, not 7"]),
        (["--seconds", "9"], ["holds results with budget"]),
    ],
)
def test_a_folder_of_other_settings_is_refused(
    finished: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: list[str]
) -> None:
    monkeypatch.delenv("PDOIK_SHARED", raising=False)
    misuse(h1("--quick", "--out", finished, *arguments), *words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--seconds", "0"], ["--seconds", "0"]),
        (["--seconds", "nan"], ["--seconds", "nan"]),
        (["--long-seconds", "-1"], ["--long-seconds", "-1"]),
        (["--ycb", "none"], ["--ycb none", "no such folder"]),
    ],
)
def test_a_bad_option_is_misuse(tmp_path: Path, arguments: list[str], words: list[str]) -> None:
    folder = tmp_path / "out"
    misuse(h1("--quick", "--out", folder, *arguments), *words)
    assert not folder.exists()


@pytest.mark.parametrize(
    "arguments",
    [["--mode", "fly"], ["--setup", "air"], ["--throws", "0"], ["--throws", "x"], ["--seed", "-1"]],
)
def test_what_is_no_choice_ends_with_status_2(tmp_path: Path, arguments: list[str]) -> None:
    invocation = h1("--quick", "--out", tmp_path / "out", *arguments)
    assert invocation.exit_code == 2
    assert arguments[0] in invocation.stderr


def test_a_folder_without_the_scans_is_misuse(tmp_path: Path) -> None:
    (tmp_path / "ycb").mkdir()
    misuse(h1("--quick", "--ycb", tmp_path / "ycb", "--out", tmp_path / "out"), "--ycb", "pcd")


def test_a_file_in_the_way_is_misuse(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    misuse(h1("--quick", "--out", tmp_path / "out"), "--out", "is a file")


def test_a_broken_result_is_named(finished: Path, tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "settings.json").write_bytes((finished / "settings.json").read_bytes())
    (tmp_path / "results" / "stand_welded.json").write_text("{")
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("PDOIK_SHARED", raising=False)
        invocation = h1("--quick", "--mode", "stand", "--setup", "welded", "--out", tmp_path)
    assert invocation.exit_code == 2
    assert "stand_welded.json: not JSON" in invocation.stderr


def test_objects_are_the_scans_where_they_are(tmp_path: Path) -> None:
    beside = Path(__file__).resolve().parents[5] / "shared"
    ycb = Path(os.environ.get("PDOIK_SHARED", beside)) / "ycb"
    if not ycb.is_dir():
        pytest.skip("needs ycb from the shared material (PDOIK_SHARED or ../shared)")
    invocation = h1(
        *("--quick", "--mode", "predict", "--setup", "welded", "--throws", "1"),
        *("--ycb", ycb, "--out", tmp_path / "out"),
    )
    assert invocation.exit_code == 0, invocation.output
    assert f"YCB, {ycb}" in invocation.stdout
    assert "YCB" in (tmp_path / "out" / "report.md").read_text()


def test_the_paper_s_throws_hit_with_every_object(tmp_path: Path) -> None:
    assert [throw.object_name for throw in PAPER_THROWS] == list(OBJECT_NAMES)
    for throw in PAPER_THROWS:
        assert control_run(build_world(PAPER, load_object(throw.object_name)), throw) is not None


def test_jobs_are_named_apart(tmp_path: Path) -> None:
    experiment = Experiment(settings_for(False), tmp_path)
    names = [job.name for job in experiment.jobs()]
    assert len(names) == len(set(names)) == 4 + (3 * 20 + 3) * (1 + 3)
    assert Job(mode="react", setup=FREE, index=7, speed=0.25).name == "react_free_007_0.25"


# Logs


def test_a_log_of_a_throw_has_the_object_in_the_pelvis_frame(tmp_path: Path) -> None:
    world = build_world(FREE, load_object(THROW.object_name))
    q = standing_posture(FREE)
    ran = simulate(world, q, hold(q), 0.1, throw=THROW)
    write_log(ran, tmp_path / "run.csv", every=10)
    lines = (tmp_path / "run.csv").read_text().splitlines()
    assert lines[0].split(",") == log_columns(with_object=True)
    assert tuple(log_columns(with_object=True)[-7:]) == OBJECT
    assert len(lines) == 1 + 10

    data = world.standing_data(q)
    mujoco.mj_forward(world.model, data)
    T_world_pelvis = np.eye(4)
    T_world_pelvis[:3, :3] = data.xmat[world.root].reshape(3, 3)
    T_world_pelvis[:3, 3] = data.xpos[world.root]
    T = np.linalg.inv(T_world_pelvis) @ THROW.pose(0.0)
    assert object_in_pelvis(ran)[0, :3] == pytest.approx(T[:3, 3], abs=1e-6)


def test_the_viewer_reads_the_logs(finished: Path) -> None:
    from pdoik.view.log import load_log

    names = pdoik.Robot.builtin("h1").joint_names
    for path in sorted((finished / "logs").glob("*.csv")):
        log = load_log(path, names)
        assert set(log.signals) == {"q_des", "q", "dq", "tau"}
        assert (log.object_pose is None) == path.stem.startswith("stand")


# Measures and checks


def test_a_push_too_hard_is_no_stand_though_feet_are_welded() -> None:
    q = standing_posture(WELDED)
    push = Push(force=(0, -400, 0), begin=0.1, end=0.4)
    world = build_world(WELDED)
    ran = simulate(world, q, hold(q), 2.0, push=push)
    assert ran.fallen
    assert not ran.stands
    assert not ran.dodged
    first = first_saturated(world, ran)
    assert first is not None
    assert "ankle" in first["joint"]
    assert 0.1 <= first["time"] <= 0.5
    assert run_measures(world, ran)["saturation"][first["joint"]] > 0.1


def test_a_run_that_stands_still_is_measured_so() -> None:
    world, q = build_world(WELDED), standing_posture(WELDED)
    found = run_measures(world, simulate(world, q, hold(q), 0.2))
    assert found["stands"]
    assert found["dodged"]
    assert found["first_saturated"] is None
    assert max(found["com_beyond_box"]) == 0
    assert found["lag"] < 1e-3


def test_beyond_the_box_is_measured_on_its_own_side() -> None:
    middle = (COM_LOWER + COM_UPPER) / 2
    off = np.array([[0, 0, 0], [-0.1, 0, 0], [0, 0.2, 0.3]])
    points = np.array([middle, COM_LOWER, COM_UPPER]) + off
    assert beyond_box(points) == pytest.approx(np.abs(off))


def test_the_judges_see_a_foot_that_is_off_and_an_object_that_is_in() -> None:
    world = build_world(WELDED, load_object(THROW.object_name))
    q = standing_posture(WELDED)
    good = check_answers(world, THROW, np.array([0.0]), q[None])
    assert good["position_error"] < 1e-6
    assert good["rotation_error"] < 1e-6
    assert good["least_distance"] > 0.4
    assert good["self_distance"] > 0
    off = q.copy()
    off[JOINT_NAMES.index("right_knee_joint")] += 0.1
    hit = check_answers(world, THROW, np.array([THROW.arrival]), off[None])
    assert hit["position_error"] > 0.02
    assert hit["rotation_error"] == pytest.approx(0.1, abs=1e-6)
    assert hit["least_distance"] < 0


def test_the_judges_see_limbs_that_touch() -> None:
    world, q = build_world(WELDED), standing_posture(WELDED)
    assert len(self_pairs(world)) > 0
    crossed = q.copy()
    crossed[JOINT_NAMES.index("left_hip_roll_joint")] = -0.4
    crossed[JOINT_NAMES.index("right_hip_roll_joint")] = 0.4
    assert check_answers(world, None, np.array([0.0]), crossed[None])["self_distance"] < 0


def test_mujoco_and_pinocchio_judge_alike() -> None:
    world, rng, kinematics = build_world(WELDED), np.random.default_rng(0), PinocchioKinematics()
    for _ in range(5):
        q = standing_posture(WELDED) + rng.uniform(-0.5, 0.5, 19)
        data = world.standing_data(q)
        world.place(data, q)
        assert data.xpos[world.feet[0]] == pytest.approx(WELDED.T_world_base[:3, 3], abs=1e-9)
        mujoco.mj_comPos(world.model, data)
        left, right = (body_pose(data, foot) for foot in world.feet)
        T_base_tip, com = kinematics(q)
        assert T_base_tip == pytest.approx(np.linalg.inv(left) @ right, abs=1e-9)
        assert left[:3, :3] @ com + left[:3, 3] == pytest.approx(
            data.subtree_com[world.root], abs=1e-9
        )


# The store


def test_plans_and_throws_come_back_as_they_were(finished: Path) -> None:
    assert throw_of(json.loads(json.dumps(plain(throw_record(THROW))))) == THROW
    stored = next(record["plan"] for record in records(finished, "predict") if "plan" in record)
    plan = plan_of(stored)
    assert isinstance(plan, Plan)
    assert plan.posture(0.0) == pytest.approx(plan.q_stand)
    assert plain(plan_record(plan)) == stored


def test_what_is_not_finite_is_stored_as_null(tmp_path: Path) -> None:
    store = Store(tmp_path, {"a": 1})
    assert store.get("x") is None
    assert store.put("x", {"v": np.array([1.0, np.inf]), "w": (1, float("nan"))}) == {
        "v": [1.0, None],
        "w": [1, None],
    }
    assert Store(tmp_path, {"a": 1}).get("x") == store.get("x")
    assert store.names() == ["x"]
    with pytest.raises(pdoik.LoadError, match="a = 1, not 2"):
        Store(tmp_path, {"a": 2})


# The report


def made_up(**changes: Any) -> dict[str, Any]:
    still = {"dodged": False, "untouched": True, "stands": False, "contact": None, "lag": 0.1,
             "lag_joint": "torso_joint", "duration": 1.0, "first_saturated": None,
             "first_lifted": None}  # fmt: skip
    return {
        "setup": "free",
        "search": {"tried": 9, "found": 3, "plans": 2},
        "plan": {"excess": 0.0},
        "checks": {"least_distance": 0.01},
        "run": still | changes,
    }


def test_causes_are_told_apart() -> None:
    assert "no posture" in cause({"search": {"tried": 9, "found": 0}})
    assert "none of them" in cause({"search": {"tried": 9, "found": 3}})
    touched = {"time": 0.7, "link": "torso_link"}
    assert "lagged by 0.10 rad (torso_joint)" in cause(made_up(contact=touched))
    answers_touch = made_up(contact=touched) | {"checks": {"least_distance": -0.004}}
    assert "the answers themselves touch, by 4 mm" in cause(answers_touch)
    first = {"joint": "left_ankle_joint", "time": 0.5}
    words = cause(made_up(first_saturated=first, first_lifted=0.6))
    assert "fell over" in words
    assert "left_ankle_joint at 0.50 s" in words
    assert "sole lifts at 0.60 s" in words


def test_dodgeable_is_dodged_or_found_by_the_longer_search() -> None:
    assert dodged(made_up(dodged=True))
    assert dodgeable(made_up(dodged=True))
    assert not dodgeable(made_up())
    assert dodgeable(made_up() | {"long": {"dodged": True}})
    assert not dodged({"long": {"dodged": True}})


def test_a_report_of_nothing_is_a_report(tmp_path: Path) -> None:
    path = write_report(Experiment(settings_for(True), tmp_path), "python -m bench.humanoid")
    assert "0 of" in path.read_text()


# Pictures


def test_a_figure_is_drawn_or_a_line_says_why_not(finished: Path) -> None:
    # A process of its own: what draws is chosen when mujoco is imported.
    environment = {key: value for key, value in os.environ.items() if key != "PDOIK_SHARED"}
    command = [sys.executable, "-m", "bench.humanoid", "--quick", "--setup", "welded", "--figure"]
    ended = subprocess.run(
        [*command, "--out", str(finished)],
        cwd=REPOSITORY,
        env=environment | {"MUJOCO_GL": "egl"},
        capture_output=True,
        text=True,
        check=False,
    )
    if not any(record.get("run", {}).get("dodged") for record in records(finished, "predict")):
        assert ended.returncode == 0, ended.stderr
        assert "nothing was dodged" in ended.stderr
        return
    if ended.returncode == 2:
        assert "cannot draw" in ended.stderr
        pytest.skip("no OpenGL here")
    assert ended.returncode == 0, ended.stderr
    assert (finished / "figure.png").read_bytes().startswith(b"\x89PNG")
