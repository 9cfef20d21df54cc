"""Further logs of a diagnosed machine are read as a study says, and pdoik's own as they are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from command_line import misuse, run
from pdoik.recordings import Reading
from pdoik.sim2real import Controller, Model, load_study
from pdoik.sim2real.infer import simulator_notes
from pdoik.sim2real.watch import CsvStream
from sim2real_robots import arm_urdf

JOINTS = ("joint1", "joint2")
OWN = Reading(columns={"q": "enc {joint} raw", "q_des": "aim {joint}"}, units={"q": "deg"})


def motion() -> tuple[np.ndarray, np.ndarray]:
    """Times (T,) and positions (T, 2) [rad]."""
    time = np.arange(0.0, 3.0, 0.01)
    return time, np.column_stack([0.5 * np.sin(2.0 * time), 0.3 * np.cos(3.0 * time)])


def write(path: Path, names: list[str], columns: np.ndarray) -> Path:
    np.savetxt(path, columns, delimiter=",", header=",".join(names), comments="", fmt="%.12g")
    return path


@pytest.fixture
def logs(tmp_path: Path) -> tuple[Path, Path]:
    """The same motion under pdoik's names and under the machine's own."""
    time, q = motion()
    ours = write(tmp_path / "ours.csv", ["time", "q.joint1", "q.joint2"], np.c_[time, q])
    names = ["time", "enc joint1 raw", "enc joint2 raw"]
    return ours, write(tmp_path / "own.csv", names, np.c_[time, np.rad2deg(q)])


def model(folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    return Model(joints=JOINTS, robot=arm_urdf(2)).save(folder)


def torques(tmp_path: Path, *arguments: Path | str) -> np.ndarray:
    done = run("predict", *arguments, "--out", tmp_path / "tau.csv")
    assert done.exit_code == 0, done.output
    return np.loadtxt(tmp_path / "tau.csv", delimiter=",", skiprows=1)


def test_what_pdoik_writes_is_read_in_its_own_units(
    tmp_path: Path, logs: tuple[Path, Path]
) -> None:
    """Of a study in degrees, too: a model reads what `replay` wrote as it was written."""
    ours, own = logs
    (tmp_path / "arm.urdf").write_text(arm_urdf(2))
    write(
        tmp_path / "degrees.csv",
        ["time", "q.joint1", "q.joint2"],
        np.loadtxt(own, delimiter=",", skiprows=1),
    )
    content = {"robot": "arm.urdf", "recordings": ["degrees.csv"], "units": {"q": "deg"}}
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(content))
    path = Model.of_study(load_study(tmp_path / "study.yaml")).save(tmp_path)
    wanted = torques(tmp_path, model(tmp_path / "plain"), ours)
    np.testing.assert_allclose(torques(tmp_path, path, ours), wanted, atol=1e-6)
    said = torques(tmp_path, path, tmp_path / "degrees.csv", "--columns", tmp_path / "study.yaml")
    np.testing.assert_allclose(said, wanted, atol=1e-6)


def test_a_study_says_how_logs_are_read(tmp_path: Path, logs: tuple[Path, Path]) -> None:
    ours, own = logs
    path = model(tmp_path)
    wanted = torques(tmp_path, path, ours)
    study = tmp_path / "study.yaml"
    content = {
        "recordings": ["own.csv"],
        "columns": {"q": "enc {joint} raw"},
        "units": {"q": "deg"},
    }
    study.write_text(yaml.safe_dump(content))
    np.testing.assert_allclose(torques(tmp_path, path, own, "--columns", study), wanted, atol=1e-6)
    said = run("predict", path, own, "--columns", study, "--out", tmp_path / "tau.csv")
    assert "read as the study says: q from 'enc {joint} raw'" in " ".join(said.output.split())
    misuse(run("predict", path, own, "--columns", tmp_path / "no.yaml"), "no.yaml")


def test_a_replay_starts_from_commands_of_the_machines_own_names(tmp_path: Path) -> None:
    time, q = motion()
    names = ["time", "aim joint1", "aim joint2"]
    commands = write(tmp_path / "aims.csv", names, np.c_[time, np.rad2deg(q)])
    controller = Controller(kp=np.full(2, 200.0), kd=np.full(2, 20.0), gravity_compensation=True)
    made = replace(Model.load(model(tmp_path)), controller=controller).save(tmp_path)
    study = tmp_path / "study.yaml"
    content = {"recordings": ["aims.csv"], "columns": dict(OWN.columns), "units": dict(OWN.units)}
    study.write_text(yaml.safe_dump(content))
    out = tmp_path / "replay.csv"
    done = run("replay", made, commands, "--columns", study, "--out", out)
    assert done.exit_code == 0, done.output
    header = (tmp_path / "replay.csv").read_text().split("\n", 1)[0].split(",")
    table = np.loadtxt(tmp_path / "replay.csv", delimiter=",", skiprows=1)
    aims = table[:, [header.index(f"q_des.{j}") for j in JOINTS]]
    np.testing.assert_allclose(aims, q, atol=1e-6)


def test_streams_are_read_as_a_study_says() -> None:
    said = Reading(columns={"q": "enc {joint}", "tau": "nm {joint}"}, units={"q": "deg"})
    stream = CsvStream("log.csv", JOINTS, said)
    text = b"time,enc joint1,enc joint2,nm joint1,nm joint2\n0,180,90,1,2\n1,0,0,3,4\n"
    (columns,) = stream.add(text)
    assert columns["q.joint1"][0] == pytest.approx(np.pi)
    assert columns["tau.joint2"].tolist() == [2.0, 4.0]


def test_a_diagnosis_points_to_compare_where_there_is_a_simulator(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(arm_urdf(2))
    time, q = motion()
    write(tmp_path / "run.csv", ["time", "q.joint1", "q.joint2"], np.c_[time, q])
    for keys, count in (({}, 0), ({"simulator": {"urdf": "arm.urdf"}}, 1)):
        content = {"robot": "arm.urdf", "recordings": ["run.csv"], **keys}
        (tmp_path / "study.yaml").write_text(yaml.safe_dump(content))
        notes = simulator_notes(load_study(tmp_path / "study.yaml"))
        assert len(notes) == count
        assert all("pdoik compare" in note and "arm.urdf" in note for note in notes)
