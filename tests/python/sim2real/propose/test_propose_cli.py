"""pdoik propose on the command line: a report by pdoik diagnose, files, words, exit statuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import pdoik
from command_line import misuse, run
from pdoik.sim2real import load_model
from pdoik.view.log import load_log
from pdoik.view.panels.replay_tab import facts
from propose_reports import friction, write_report, write_study
from studies import JOINTS


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report by the tool itself, of an arm that was moved slowly within a few degrees."""
    folder = tmp_path_factory.mktemp("diagnosed")
    study = write_study(folder, width=0.003)
    made = run("diagnose", study, "--out", folder / "report", "--quick")
    assert made.exit_code == 0, made.output
    return folder / "report"


@pytest.fixture(scope="module")
def moved(diagnosed: Path) -> tuple[Path, str]:
    """motion.csv of that report, and what was said."""
    output = diagnosed.parent / "motion.csv"
    made = run("propose", diagnosed, "--seconds", "12", "--out", output, "--search", "8")
    assert made.exit_code == 0, made.output
    return output, " ".join((made.stdout + made.stderr).split())


def test_a_diagnosis_that_lists_others_gets_a_motion(
    diagnosed: Path, moved: tuple[Path, str]
) -> None:
    diagnosis = json.loads((diagnosed / "diagnosis.json").read_text())
    open_ones = [f for f in diagnosis["findings"] if f["equivalents"] or f["confidence"] < 0.9]
    assert open_ones or diagnosis["suspected"]
    table = pd.read_csv(moved[0])
    assert list(table.columns) == [
        "time",
        *(f"{channel}.{joint}" for channel in ("q_des", "dq_des") for joint in JOINTS),
    ]
    assert table.time.iloc[-1] == pytest.approx(12.0)
    assert np.allclose(np.diff(table.time), 0.01)
    assert np.allclose(table.filter(like="dq_des").iloc[[0, -1]], 0.0, atol=1e-6)


def test_what_to_do_is_said(diagnosed: Path, moved: tuple[Path, str]) -> None:
    path, said = moved
    assert "expected" in said
    assert "log likelihood ratio" in said
    assert "the robot has no hulls: only limits" in said
    assert f"pdoik view ROBOT.urdf --replay {path}" in said
    assert "'role: fit'" in said
    assert f"pdoik diagnose STUDY.yaml --out {diagnosed}" in said


def test_the_page_shows_the_motion_with_the_expected_confidence(moved: tuple[Path, str]) -> None:
    log = load_log(moved[0], JOINTS)
    assert log.postures == ["q_des"]
    content = json.loads(moved[0].with_suffix(".json").read_text())
    shown = facts(log, 3.0, list(JOINTS))
    for each in content["expected"]:
        assert f"**expected {each['confidence']:.2f}**" in shown
    moved[0].with_suffix(".json").rename(moved[0].with_suffix(".aside"))
    assert load_log(moved[0], JOINTS).expected == ""
    moved[0].with_suffix(".aside").rename(moved[0].with_suffix(".json"))


def test_the_report_knows_its_study(diagnosed: Path) -> None:
    assert load_model(diagnosed).study == str(diagnosed.parent / "study.yaml")


def test_a_random_motion_is_of_the_same_length(diagnosed: Path, tmp_path: Path) -> None:
    output = tmp_path / "random.csv"
    made = run("propose", diagnosed, "--random", "--seconds", "12", "--out", output, "--rate", "50")
    assert made.exit_code == 0, made.output
    assert len(pd.read_csv(output)) == 601
    assert json.loads(output.with_suffix(".json").read_text())["random"] is True


def test_nothing_to_settle_has_a_status_of_its_own(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), friction())
    made = run("propose", report, "--out", tmp_path / "motion.csv")
    assert made.exit_code == 3
    assert "nothing to settle" in made.stderr
    assert not (tmp_path / "motion.csv").exists()


def test_misuse_is_said_in_a_line(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), friction("presliding_hysteresis"))
    output = tmp_path / "motion.csv"
    misuse(run("propose", tmp_path / "none", "--out", output), "no such folder")
    misuse(run("propose", report, "--out", tmp_path / "motion.json"), "expected a CSV")
    misuse(run("propose", report, "--out", tmp_path / "no" / "motion.csv"), "no such folder")
    misuse(run("propose", report, "--out", output, "--seconds", "1"), "1 s is too short")
    misuse(run("propose", report, "--out", output, "--start", "a b"), "--start", "'a b'")
    (report / "model.json").unlink()
    misuse(run("propose", report, "--out", output), "model.json: no such file")


def test_a_cloud_needs_hulls(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), friction("presliding_hysteresis"))
    cloud = tmp_path / "points.xyz"
    cloud.write_text("1.0 0.0 0.5\n")
    made = run("propose", report, "--out", tmp_path / "motion.csv", "--cloud", cloud)
    assert made.exit_code == 2
    assert "no hulls to keep off them: --occupancy" in " ".join(made.stderr.split())


CELL = """<mujoco><worldbody><body name="stand" pos="3 1 1">
  <body name="{name}upper"><joint name="{name}shoulder" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
    <body name="{name}fore" pos="0.4 0 0"><joint name="{name}elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.04"/></body></body>
  <body name="crate" pos="0.4 0 0"><geom type="box" size="0.3 0.3 0.3"/></body>
  <body name="wall" pos="0 0.5 0"><geom type="box" size="1 0.1 1"/></body>
</body></worldbody></mujoco>"""


def test_a_scene_that_has_the_robot_is_kept_off_without_it(tmp_path: Path) -> None:
    report = write_report(tmp_path, write_study(tmp_path), friction("presliding_hysteresis"))
    hulls = tmp_path / "hulls.yaml"
    ends = {"upper": (0.4, 0.0, 0.0), "fore": (0.3, 0.0, 0.0)}
    capsules = [(link, (0.0, 0.0, 0.0), end, 0.05) for link, end in ends.items()]
    pdoik.Occupancy(capsules=capsules).save(str(hulls))
    for name in ("", "other_"):
        (tmp_path / f"{name}cell.xml").write_text(CELL.format(name=name))
    output = tmp_path / "motion.csv"
    asked = ("propose", report, "--out", output, "--seconds", "8", "--search", "2")
    asked += ("--occupancy", hulls, "--frame", "stand", "--scene")
    made = run(*asked, tmp_path / "cell.xml", "--without", "crate")
    assert made.exit_code == 0, made.output
    said = " ".join((made.stdout + made.stderr).split())
    assert "cell.xml: without" in said
    assert "upper" in said
    assert "crate" in said
    clearance = json.loads(output.with_suffix(".json").read_text())["clear"]["clearance"]
    assert clearance == pytest.approx(0.4 - 0.05, abs=1e-6)  # to the wall, beside which it moves

    output.unlink()
    for shut in (("cell.xml",), ("other_cell.xml", "--without", "crate")):
        assert run(*asked, tmp_path / shut[0], *shut[1:]).exit_code == 2
        assert not output.exists()
    misuse(run(*asked, tmp_path / "none.xml"), "--scene", "no such file")
