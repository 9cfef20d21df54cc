"""pdoik study new: a study that loads as it stands, with guesses said and questions asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

import mujoco

import pdoik
from command_line import misuse, run
from pdoik.errors import LoadError
from pdoik.sim2real import Draft, draft_study, load_study
from studies import MJCF, URDF, columns, log

GAINS = """  <actuator>
    <position joint="elbow" kp="90" kv="5" gear="2"/>
    <position joint="shoulder" kp="120" kv="7" forcerange="-40 40"/>
  </actuator>
</mujoco>
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.format(mass=1))
    return path


def logged(folder: Path, **tables: pd.DataFrame) -> list[Path]:
    paths = []
    for name, table in tables.items():
        paths.append(folder / f"{name}.csv")
        table.to_csv(paths[-1], index=False)
    return paths


def other(seconds: float = 8.0, scale: float = 0.7) -> pd.DataFrame:
    """The arm's motion at another pace."""
    time = np.arange(round(seconds * 100)) / 100
    table = columns(0.8 * time)
    table = {k: v * (scale if k.startswith("q.") else 1.0) for k, v in table.items()}
    table |= {"time": time, **{k: 0.8 * scale * v for k, v in table.items() if k[:3] == "dq."}}
    return pd.DataFrame(table)


def loaded(draft: Draft, folder: Path):
    path = folder / "drafted.yaml"
    path.write_text(draft.text)
    return load_study(path)


def test_a_draft_loads_and_names_what_is_there(robot: Path, tmp_path: Path) -> None:
    draft = draft_study(robot, logged(tmp_path, a=log(), b=log(9.0), c=other()), folder=tmp_path)
    study = loaded(draft, tmp_path)
    assert study.joints == ("shoulder", "elbow")
    assert study.robot == robot
    assert [each.name for each in study.recordings] == ["a.csv", "b.csv", "c.csv"]
    assert yaml.safe_load(draft.text)["robot"] == "arm.urdf"  # beside the study
    for key in ("controller", "payload", "session", "rotor_inertia", "tip", "units", "trust"):
        assert f"# {key}" in draft.text, key
    for asked in ("tau", "rotor", "held", "q_des", "one day"):
        assert any(asked in question for question in draft.questions), asked
    assert all(f"# ?  {question}" in draft.text for question in draft.questions)


def test_held_out_is_what_the_others_cover_and_do_not_repeat(robot: Path, tmp_path: Path) -> None:
    """Two recordings of one motion, one of less of it at another pace, one that goes farther."""
    wide = log()
    wide[["q.shoulder", "q.elbow"]] *= 2.0
    paths = logged(tmp_path, a=log(), again=log(9.0), slower=other(), wide=wide)
    study = loaded(draft_study(robot, paths, folder=tmp_path), tmp_path)
    assert [each.name for each in study.validate] == ["slower.csv"]


def test_of_one_recording_or_two_unlike_ones_none_is_held_out(robot: Path, tmp_path: Path) -> None:
    (path,) = logged(tmp_path, a=log())
    one = draft_study(robot, [path], folder=tmp_path)
    assert "role: validate" not in one.text
    assert loaded(one, tmp_path).split.startswith("by blocks")
    apart = log()
    apart[["q.shoulder", "q.elbow"]] = 0.3 * apart[["q.shoulder", "q.elbow"]] + 1.5
    two = draft_study(robot, logged(tmp_path, a=log(), b=apart), folder=tmp_path)
    assert "role: validate" not in two.text


@pytest.mark.parametrize(
    ("channel", "factor", "unit"), [("q", 180 / np.pi, "deg"), ("dq", 30 / np.pi, "rpm")]
)
def test_units_are_guessed_and_asked_about(
    robot: Path, tmp_path: Path, channel: str, factor: float, unit: str
) -> None:
    table = log()
    table[[f"{channel}.shoulder", f"{channel}.elbow"]] *= factor
    draft = draft_study(robot, logged(tmp_path, a=table), folder=tmp_path)
    assert yaml.safe_load(draft.text)["units"] == {channel: unit}
    assert any(f"is {channel} in {unit}?" in question for question in draft.questions)
    q = loaded(draft, tmp_path).recordings[0].q
    want = log()[["q.shoulder", "q.elbow"]].to_numpy()[: len(q)]
    np.testing.assert_allclose(q, want, atol=1e-9)


def test_milliseconds_are_guessed(robot: Path, tmp_path: Path) -> None:
    table = log()
    table["time"] *= 1e3
    draft = draft_study(robot, logged(tmp_path, a=table), folder=tmp_path)
    assert yaml.safe_load(draft.text)["units"] == {"time": "ms"}


def test_gains_are_those_of_the_actuators_as_mujoco_has_them(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(MJCF.format(mass=1).replace("</mujoco>", GAINS))
    table = log()
    for joint in ("shoulder", "elbow"):
        table[f"q_des.{joint}"] = table[f"q.{joint}"] + 0.01
    draft = draft_study(path, logged(tmp_path, a=table), folder=tmp_path)
    told = yaml.safe_load(draft.text)["controller"]
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for k, joint in enumerate(("shoulder", "elbow")):  # torque per command, and per speed
        at, actuator = model.joint(joint).dofadr[0], 1 - k
        torques = []
        for command, speed in ((0.0, 0.0), (1e-3, 0.0), (0.0, 1e-3)):
            data.qpos[:], data.qvel[:], data.ctrl[:] = 0.0, 0.0, 0.0
            gear = model.actuator_gear[actuator, 0]
            data.ctrl[actuator], data.qvel[at] = gear * command, speed  # of the actuator's length
            mujoco.mj_forward(model, data)
            torques.append(data.qfrc_actuator[at])
        assert told["kp"][k] == pytest.approx((torques[1] - torques[0]) / 1e-3)
        assert told["kd"][k] == pytest.approx(-(torques[2] - torques[0]) / 1e-3)
    controller = loaded(draft, tmp_path).controller
    assert controller is not None
    np.testing.assert_allclose(controller.kp, told["kp"])
    assert any("gains" in question for question in draft.questions)


def test_a_log_that_cannot_be_used_is_left_out_and_named(robot: Path, tmp_path: Path) -> None:
    paths = logged(tmp_path, short=log(1.0), good=log(), still=log() * 0.0 + log()[["time"]])
    still = log()
    still[[name for name in still if name != "time"]] = 0.1
    still.to_csv(paths[2], index=False)
    draft = draft_study(robot, paths, folder=tmp_path)
    study = loaded(draft, tmp_path)
    files = {each.file or each.name for each in study.recordings}
    assert files == {"good.csv", "still.csv"}  # at rest, but of use beside the other
    assert any("short.csv" in guess and "too short" in guess for guess in draft.guesses)


def test_bad_input_is_named(robot: Path, tmp_path: Path) -> None:
    (good,) = logged(tmp_path, good=log())
    with pytest.raises(LoadError, match=r"no such log.*nearest: 'good.csv'"):
        draft_study(robot, [tmp_path / "goo.csv"])
    with pytest.raises(LoadError, match=r"no such file.*nearest: 'arm.urdf'"):
        draft_study(tmp_path / "arn.urdf", [good])
    renamed = log().rename(columns=lambda name: name.replace("elbow", "elbo").replace("er", "re"))
    (foreign,) = logged(tmp_path, foreign=renamed)
    with pytest.raises(LoadError, match=r"no joint 'shouldre' that moves; nearest: 'shoulder'"):
        draft_study(robot, [foreign])
    (tmp_path / "broken.mcap").write_bytes(b"nothing of the kind")
    with pytest.raises(LoadError, match=r"broken.mcap"):
        draft_study(robot, [tmp_path / "broken.mcap"])
    apart = [
        log().drop(columns=[f"{c}.{joint}" for c in ("q", "dq", "tau")])
        for joint in ("shoulder", "elbow")
    ]
    draft = draft_study(robot, logged(tmp_path, one=apart[0], two=apart[1]), folder=tmp_path)
    assert any("two.csv" in guess and "q.<joint>" in guess for guess in draft.guesses)


def test_the_command_asks_and_overwrites_only_when_told(robot: Path, tmp_path: Path) -> None:
    (path,) = logged(tmp_path, a=log())
    out = tmp_path / "study.yaml"
    first = run("study", "new", robot, path, "--out", out)
    assert first.exit_code == 0, first.output
    assert "To be answered" in first.stdout
    assert first.stdout.splitlines()[-1] == str(out)
    load_study(out)
    out.write_text("mine")
    misuse(run("study", "new", robot, path, "--out", out), "is there already", "--force")
    assert out.read_text() == "mine"
    assert run("study", "new", robot, path, "--out", out, "--force").exit_code == 0
    load_study(out)
    misuse(run("study", "new", robot, path, "--out", tmp_path / "no" / "s.yaml"), "no folder")


def test_the_robot_may_be_a_name_or_a_xacro_file(robot: Path, tmp_path: Path) -> None:
    (path,) = logged(tmp_path, a=log())
    macros = tmp_path / "machine.xacro"
    text = robot.read_text().replace("<robot ", '<robot xmlns:xacro="http://ros.org/xacro" ', 1)
    macros.write_text(text.replace('value="1"', 'value="$(arg mass)"'))
    out = tmp_path / "study.yaml"
    arguments = ["study", "new", macros, path, "--xacro-arg", "mass:=1", "--out", out]
    assert run(*arguments).exit_code == 0
    assert load_study(out).robot == tmp_path / "machine.urdf"
    (tmp_path / "machine.urdf").write_text("mine")
    misuse(run(*arguments[:-1], tmp_path / "b.yaml"), "machine.urdf", "is another", "--force")

    time = np.arange(800) / 100
    table = {"time": time}
    for k, joint in enumerate(pdoik.Robot.builtin("ur10").joint_names):
        table[f"q.{joint}"] = np.sin((0.6 + 0.2 * k) * time)
    (path,) = logged(tmp_path, ur10=pd.DataFrame(table))
    done = run("study", "new", "UR10", path, "--out", out, "--force")
    assert done.exit_code == 0, done.output
    assert load_study(out).robot == tmp_path / "ur10.urdf"
    misuse(run("study", "new", "ur11", path, "--out", out, "--force"), "ur11")
