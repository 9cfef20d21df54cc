"""Logs as other programs write them: preambles, units, separators, clocks and counted joints."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

from scipy.io import savemat

from command_line import misuse, run
from pdoik.descriptions import robot_facts
from pdoik.errors import LoadError
from pdoik.recordings import Column, FloatArray
from pdoik.recordings.logs import CsvForm
from pdoik.recordings.names import Known, settle
from pdoik.sim2real import Study, draft_study, load_study
from sim2real_motions import wave, write_arm

STEP = 0.01
TIME = STEP * np.arange(800)
Q, DQ = (wave(TIME, 3, order) for order in range(2))
TAU = 5.0 * Q + 0.2 * DQ
NAMES = [f"{channel}{k}" for channel in ("q", "dq", "tau") for k in (1, 2, 3)]
NUMBERS = np.column_stack([TIME, Q, DQ, TAU])


def table(names: list[str] | None = None, time: str = "time") -> pd.DataFrame:
    return pd.DataFrame(NUMBERS, columns=[time, *(names or NAMES)])


def counted(position: str, speed: str, torque: str, first: int) -> list[str]:
    return [each.format(k=k + first) for each in (position, speed, torque) for k in range(3)]


def rtde(path: Path) -> None:
    """Cells parted by a space, joints counted from 0."""
    names = counted("actual_q_{k}", "actual_qd_{k}", "actual_moment_{k}", 0)
    table(names, "timestamp").to_csv(path, sep=" ", index=False)


def aligned(path: Path) -> None:
    """Columns of one width, and a remark as header."""
    np.savetxt(path, NUMBERS, fmt="%14.9f", header=" ".join(["time", *NAMES]))


def decimal_commas(path: Path) -> None:
    table().to_csv(path, sep=";", decimal=",", index=False)


def units_below(path: Path) -> None:
    """A remark, names, units, numbers; angles in degrees, times in ms."""
    numbers = table()
    numbers["time"] *= 1e3
    numbers.iloc[:, 1:7] = np.rad2deg(numbers.iloc[:, 1:7])
    head = [list(numbers.columns), ["ms", *["deg"] * 3, *["deg/s"] * 3, *["Nm"] * 3]]
    text = "\n".join(["# bench 3, by hand", *(",".join(each) for each in head), ""])
    path.write_text(text + numbers.to_csv(index=False, header=False))


def labview(path: Path) -> None:
    """Lines of another kind before."""
    text = "LabVIEW Measurement\nWriter_Version\t2\nDate\t2026/03/01\n***End_of_Header***\n\n"
    path.write_text(text + table().to_csv(sep="\t", index=False))


def names_in_two_lines(path: Path) -> None:
    numbers = table()
    parts = [(each, f"j{k}") for each in ("q", "dq", "tau") for k in (1, 2, 3)]
    numbers.columns = pd.MultiIndex.from_tuples([("time", ""), *parts])
    numbers.to_csv(path, index=False)


def windows(path: Path) -> None:
    """Not UTF-8."""
    path.write_bytes(table().assign(**{"Temp °C": 20.0}).to_csv(index=False).encode("cp1252"))


def dates(path: Path) -> None:
    numbers = table()
    numbers["time"] = pd.Timestamp("2026-03-01 10:00") + pd.to_timedelta(numbers["time"], unit="s")
    numbers.to_csv(path, index=False)


def dates_in_a_zone(path: Path) -> None:
    numbers = table()
    start = pd.Timestamp("2026-03-01 10:00", tz="UTC")
    moments = start + pd.to_timedelta(numbers["time"], unit="s")
    numbers["time"] = moments.dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ")
    numbers.to_csv(path, index=False)


def times_of_the_day(path: Path) -> None:
    numbers = table()
    moments = pd.Timestamp("2026-03-01 10:00") + pd.to_timedelta(numbers["time"], unit="s")
    numbers["time"] = moments.dt.strftime("%H:%M:%S.%f")
    numbers.to_csv(path, index=False)


def stamps_in_two(path: Path) -> None:
    """Seconds and nanoseconds of ROS, and arrays of a JointState."""
    numbers = table(counted("position[{k}]", "velocity[{k}]", "effort[{k}]", 0)).drop(
        columns="time"
    )
    count = np.arange(len(TIME)) + 37  # of steps since the last whole second
    numbers.insert(0, "header.stamp.sec", 1_700_000_000 + count // 100)
    numbers.insert(1, "header.stamp.nanosec", 10_000_000 * (count % 100))
    numbers.to_csv(path, index=False)


def ticks_of_a_quadruped(path: Path) -> None:
    """A list of objects with a state for each motor, and a counter of milliseconds."""
    rows = (
        {
            "tick": round(1000 * t),
            "motor_state": [
                {"q": a, "dq": b, "tau_est": c} for a, b, c in zip(*state, strict=True)
            ],
        }
        for t, *state in zip(TIME, Q.tolist(), DQ.tolist(), TAU.tolist(), strict=True)
    )
    path.write_text("".join(json.dumps(each) + "\n" for each in rows))


def records(path: Path) -> None:
    path.write_text(table().to_json(orient="records"))


def lists(path: Path) -> None:
    """One object on several lines, joints by name and in another order."""
    order = [1, 0, 2]
    content = {
        "joint_names": [f"j{k + 1}" for k in order],
        "time": TIME.tolist(),
        "position": Q[:, order].tolist(),
        "velocity": DQ[:, order].tolist(),
        "effort": TAU[:, order].tolist(),
    }
    path.write_text(json.dumps(content, indent=1))


def matlab(path: Path) -> None:
    """A structure, one of its matrices lying down."""
    savemat(path, {"log": {"t": TIME, "q": Q, "dq": DQ.T, "tau": TAU}, "note": "by hand"})


def arrays(path: Path) -> None:
    np.savez(path, q=Q, dq=DQ, tau_J=TAU, time=TIME)


KINDS: list[tuple[Callable[[Path], None], str]] = [
    *((each, "csv") for each in (decimal_commas, units_below, names_in_two_lines, windows)),
    *((each, "csv") for each in (rtde, dates, dates_in_a_zone, times_of_the_day, stamps_in_two)),
    *((each, "txt") for each in (aligned, labview)),
    *((each, "json") for each in (records, lists)),
    (ticks_of_a_quadruped, "jsonl"),
    (matlab, "mat"),
    (arrays, "npz"),
]


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    return write_arm(tmp_path, 3)


def loaded(text: str, folder: Path) -> Study:
    path = folder / "drafted.yaml"
    path.write_text(text)
    return load_study(path)


def whole(study: Study, channel: str) -> FloatArray:
    return np.concatenate([getattr(each, channel) for each in study.recordings])


@pytest.mark.parametrize(("write", "suffix"), KINDS, ids=lambda each: getattr(each, "__name__", ""))
def test_a_draft_reads_what_other_programs_write(
    tmp_path: Path, arm: Path, write: Callable[[Path], None], suffix: str
) -> None:
    log = tmp_path / f"log.{suffix}"
    write(log)
    study = loaded(draft_study(arm, [log], folder=tmp_path).text, tmp_path)
    assert study.joints == ("j1", "j2", "j3")
    assert study.recordings[0].raw_period == pytest.approx(STEP, rel=1e-3)
    for channel, true in (("q", Q), ("dq", DQ), ("tau", TAU)):
        read = whole(study, channel)
        at = np.round(np.linspace(50, 300, 6)).astype(int)
        assert read[at] == pytest.approx(true[at], abs=2e-3), channel


def test_joints_that_are_counted_are_those_of_the_one_chain_and_said_to_be(
    tmp_path: Path, arm: Path
) -> None:
    log = tmp_path / "log.npz"
    arrays(log)
    draft = draft_study(arm, [log], folder=tmp_path)
    assert any("is j1, j2, j3 their order" in each for each in draft.questions)
    assert "by the joints' order from the base" in draft.text


def branching(folder: Path) -> Path:
    """The arm, with a gripper of two fingers at its tool."""
    text = write_arm(folder, 3).read_text().removesuffix("</robot>")
    for side in ("left", "right"):
        text += f"""<link name="{side}"><inertial><mass value="0.1"/>
          <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
          <joint name="{side}_finger" type="prismatic"><parent link="tool"/><child link="{side}"/>
          <axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="9" velocity="1"/></joint>"""
    path = folder / "gripper.urdf"
    path.write_text(text + "</robot>")
    return path


def test_an_arm_ends_where_it_branches(tmp_path: Path) -> None:
    path = branching(tmp_path)
    assert robot_facts(path).arm == ("j1", "j2", "j3")
    log = tmp_path / "log.npz"
    arrays(log)
    assert loaded(draft_study(path, [log]).text, tmp_path).joints == ("j1", "j2", "j3")


def test_joints_of_one_link_follow_one_another(tmp_path: Path) -> None:
    geom = '<geom size="0.1" mass="1"/>'
    inner = f'<body name="c"><joint name="turn"/>{geom}</body>'
    text = f"""<mujoco><worldbody><body name="a"><joint name="pan"/>{geom}
        <body name="b" pos="0 0 1"><joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/>
        {geom}{inner}</body></body></worldbody></mujoco>"""
    path = tmp_path / "wrist.xml"
    path.write_text(text)
    assert robot_facts(path).arm == ("pan", "x", "y", "turn")


def test_numbers_of_more_joints_than_the_chain_are_asked_about(tmp_path: Path) -> None:
    path = branching(tmp_path)
    log = tmp_path / "log.npz"
    np.savez(log, time=TIME, q=np.hstack([Q, Q[:, :2]]))
    with pytest.raises(LoadError, match="its 5 numbers are of no named joints; give 'joints:'"):
        draft_study(path, [log])


def test_what_a_draft_cannot_guess_may_be_told(tmp_path: Path, arm: Path) -> None:
    log, said = tmp_path / "log.csv", tmp_path / "said.yaml"
    table(counted("enc {k}", "speed of {k}", "current {k}", 1), "count").to_csv(log, index=False)
    with pytest.raises(LoadError, match="expected a column 'time'"):
        draft_study(arm, [log])
    told = {
        "joints": ["j1", "j2", "j3"],
        "columns": {"time": "count", "q": "enc {index}", "dq": "speed of {index}"},
        "units": {"current": "mA"},
    }
    said.write_text(yaml.safe_dump(told))
    draft = draft_study(arm, [log], folder=tmp_path, reading=said)
    study = loaded(draft.text, tmp_path)
    assert whole(study, "q")[200] == pytest.approx(Q[200], abs=2e-3)
    assert whole(study, "current")[200] == pytest.approx(1e-3 * TAU[200], abs=2e-5)
    content = yaml.safe_load(draft.text)
    assert content["columns"] == told["columns"]
    assert content["units"] == told["units"]


@pytest.mark.parametrize("write", [units_below, dates, stamps_in_two])
def test_a_study_has_the_last_word_on_a_column_of_times_but_not_on_dates_and_stamps(
    tmp_path: Path, arm: Path, write: Callable[[Path], None]
) -> None:
    log = tmp_path / "log.csv"
    write(log)
    content = yaml.safe_load(draft_study(arm, [log], folder=tmp_path).text)
    content["units"] = {**(content.get("units") or {}), "time": "ms"}
    if write is units_below:
        log.write_text(log.read_text().replace("\nms,", "\nus,"))  # the logger's mistake
    read = loaded(yaml.safe_dump(content), tmp_path)
    assert read.recordings[0].raw_period == pytest.approx(STEP, rel=1e-3)


def test_rows_that_are_counted_are_in_seconds_whatever_unit_times_have(
    tmp_path: Path, arm: Path
) -> None:
    log = tmp_path / "log.csv"
    table().drop(columns="time").to_csv(log, index=False)
    said = tmp_path / "said.yaml"
    said.write_text("units: {time: ms}\n")
    draft = draft_study(arm, [log], folder=tmp_path, reading=said, entry={"rate": 1.0 / STEP})
    assert loaded(draft.text, tmp_path).recordings[0].raw_period == pytest.approx(STEP)


def side_by_side(path: Path) -> None:
    """Two environments of a simulator, the second at rest."""
    pairs = {"joint_pos": Q, "joint_vel": DQ, "applied_torque": TAU}
    both = {key: np.stack([each, 0.0 * each], axis=1) for key, each in pairs.items()}
    np.savez(path, sim_time=TIME, **both)


def test_of_environments_side_by_side_one_is_asked_for(tmp_path: Path, arm: Path) -> None:
    log, study = tmp_path / "log.npz", tmp_path / "study.yaml"
    side_by_side(log)
    with pytest.raises(LoadError, match="it is of 2 environments; 'env: 0' says which"):
        draft_study(arm, [log])
    done = run("study", "new", arm, log, "--entry", "env=0", "--out", study)
    assert done.exit_code == 0, done.output
    found = load_study(study)
    assert whole(found, "tau")[200] == pytest.approx(TAU[200], abs=2e-3)
    text = study.read_text()
    study.write_text(text.replace("env: 0", "env: 1"))
    with pytest.raises(LoadError, match="no joint moves"):
        load_study(study)
    for value, why in (("2", "it has no environment 2, but 2"), ("-1", "expected a number from 0")):
        study.write_text(text.replace("env: 0", f"env: {value}"))
        with pytest.raises(LoadError, match=why):
            load_study(study)
    misuse(run("study", "new", arm, log, "--entry", "env"), "expected KEY=VALUE")


@pytest.mark.parametrize(
    ("write", "why"),
    [
        (lambda path: path.write_bytes(b"MATLAB 7.3 MAT-file" + bytes(500)), "of version 7.3"),
        (lambda path: path.write_bytes(b"MATLAB 5.0 MAT-file" + bytes(500)), "no MATLAB file"),
        (lambda path: savemat(path, {"note": "none"}), "no variables of numbers"),
    ],
)
def test_a_matlab_file_that_cannot_be_read_says_why(
    tmp_path: Path, arm: Path, write: Callable[[Path], None], why: str
) -> None:
    log = tmp_path / "log.mat"
    write(log)
    with pytest.raises(LoadError, match=why):
        draft_study(arm, [log])


@pytest.mark.parametrize(
    ("names", "target"),
    [
        (("time", "tick"), "time"),
        (("system_time", "clock"), "system_time"),
        (("rosbagTimestamp",), "rosbagTimestamp"),
        (("tick",), "tick"),
    ],
)
def test_a_plain_time_goes_before_ticks(names: tuple[str, ...], target: str) -> None:
    settled, _ = settle("log", [Column(name=each) for each in names], Known())
    assert [each.column.name for each in settled if each.target == "time"] == [target]


@pytest.mark.parametrize(
    ("text", "header", "first"),
    [
        ("time,q.a\n0,1\n", ("time", "q.a"), 1),
        ("time,q.a\nNone,null\n0.1,2\n", ("time", "q.a"), 1),  # nothing was there yet
        ("time,mode,on\n0.1,RUN,yes\n0.2,RUN,yes\n", ("time", "mode", "on"), 1),
        ("Robot,UR5e\nSerial,2017\n\ntime,q.a\n0,1\n", ("time", "q.a"), 4),
        ("% of Monday, by hand\n% time q.a\n0 1\n", ("time", "q.a"), 2),
        ("time,q,q\ns,a,b\n0,1,2\n", ("time.s", "q.a", "q.b"), 2),  # names, not units
        ("time,0,1\n0.1,2,3\n", ("time", "0", "1"), 1),
    ],
)
def test_names_stand_above_the_first_numbers(
    text: str, header: tuple[str, ...], first: int
) -> None:
    form = CsvForm.of_lines("log", text.splitlines(keepends=True))
    assert form.header == header
    assert form.first == first
