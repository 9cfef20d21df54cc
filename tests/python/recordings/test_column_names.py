"""Columns are known by the names that other programs give them, or by what the study says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import Column
from pdoik.recordings.names import Known, columns_key, naming_notes, settle
from pdoik.sim2real.study import load_study
from studies import JOINTS, log, motion, speed, write_study

ARM = ("joint1", "joint2", "joint3")
UR = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")


def read_as(
    *names: str, joints: tuple[str, ...] | None = ARM, columns: Any = None, **known: Any
) -> dict[str, str]:
    """What columns are read as, by name."""
    found, _ = settle(
        "a.csv",
        [Column(name=name) for name in names],
        Known(joints=joints, key=columns_key(columns, "study.yaml: columns"), **known),
    )
    return {each.column.name: f"{each.target} {each.unit}".strip() for each in found}


SPELLINGS = {
    "position.joint1": "q.joint1",
    "joint1_pos": "q.joint1",
    "effort_joint1": "tau.joint1",
    "joint1/position": "q.joint1",
    "pos_joint1": "q.joint1",
    "Joint1Velocity": "dq.joint1",
    "joint_1_vel": "dq.joint1",
    "/joint_states/joint1/position": "q.joint1",
    "/left_arm/joint_states/joint1/effort": "tau.joint1",
    "/controller/state/reference/joint1/position": "q_des.joint1",
    "position[joint1]": "q.joint1",
    "joint1_pos_deg": "q.joint1 deg",
    "joint1 torque [Nm]": "tau.joint1 N.m",
    "joint1 torque (mN m)": "tau.joint1 mN.m",
    "q (rad) joint1": "q.joint1 rad",
    "vel_joint1_rad_s": "dq.joint1 rad/s",
    "velocity joint1 [deg/s]": "dq.joint1 deg/s",
    "joint1.current_mA": "current.joint1 mA",
    "joint1_current_position": "q.joint1",
    "joint1_goal_position": "q_des.joint1",
    "present_current_joint1": "current.joint1",
    "cmd_torque_joint1": "tau_cmd.joint1",
    "joint1_velocity_setpoint": "dq_des.joint1",
    "qDes_joint1": "q_des.joint1",
    "tau_J.joint1": "tau.joint1",
    "q_d joint1": "q_des.joint1",
    "joint1_pwm_%": "duty.joint1 %",
    "j1_measured_position": "",
    "error_joint1_position": "",
    "joint1_position_error": "",
    "state[joint1].tau_est": "tau.joint1",
    "joint1_acceleration": "",
    "joint1_temperature": "",
    "target_current_joint1": "",
    "torque_limit_joint1": "",
    "tau_ext_joint1": "",
    "joint1_pos_x": "",
    "joint1_position_filtered": "",
    "joint1_position [counts]": "",
    "joint1_position_time": "",
    "joint4_position": "",
    "gripper_position": "",
    "position": "",
}


@pytest.mark.parametrize("name", SPELLINGS)
def test_a_spelling_says_channel_joint_and_unit(name: str) -> None:
    assert read_as(name).get(name, "") == SPELLINGS[name]


@pytest.mark.parametrize(
    "name",
    ["time", "t", "timestamp", "__time", "Time [s]", "stamp", "time_s", "%time", "header.stamp"],
)
def test_a_spelling_says_that_it_is_the_time(name: str) -> None:
    assert read_as(name)[name] in ("time", "time s")


def test_units_of_times_are_read_and_durations_are_no_times() -> None:
    assert read_as("time_ms")["time_ms"] == "time ms"
    assert read_as("Timestamp [us]")["Timestamp [us]"] == "time us"
    assert not read_as("planning_time")
    assert not read_as("joint1_time")


def test_the_longest_joint_name_counts() -> None:
    joints = ("elbow", "left_elbow", "left_elbow_roll")
    assert read_as("left_elbow_roll_pos", "left_elbow_pos", "elbow_pos", joints=joints) == {
        "left_elbow_roll_pos": "q.left_elbow_roll",
        "left_elbow_pos": "q.left_elbow",
        "elbow_pos": "q.elbow",
    }


def test_joints_are_known_without_what_all_their_names_share() -> None:
    panda = ("panda_joint1", "panda_joint2")
    assert read_as("joint2_pos", joints=panda) == {"joint2_pos": "q.panda_joint2"}
    assert read_as("shoulder_pan.pos", "elbow.vel", joints=UR) == {
        "shoulder_pan.pos": "q.shoulder_pan_joint",
        "elbow.vel": "dq.elbow_joint",
    }
    left = ("left_hip", "left_knee")
    assert read_as("hip_pos", "right_hip_pos", joints=left) == {"hip_pos": "q.left_hip"}


def test_numbers_count_the_studys_joints_from_zero_or_one() -> None:
    for first in (0, 1):
        names = [f"{word}_{k + first}" for word in ("actual_q", "target_q") for k in range(3)]
        expected = [f"{word}.{joint}" for word in ("q", "q_des") for joint in UR]
        assert list(read_as(*names, joints=UR).values()) == expected
    names = [f"q[{k}]" for k in range(3)]
    assert list(read_as(*names, joints=UR).values()) == [f"q.{joint}" for joint in UR]
    assert list(read_as("q1", "q2", "q3", joints=UR).values()) == [f"q.{joint}" for joint in UR]


def test_an_order_is_said_in_a_note() -> None:
    columns = [Column(name=f"actual_q_{k}") for k in range(3)]
    found, _ = settle("a.csv", columns, Known(joints=UR))
    (note,) = naming_notes(found)
    assert note.startswith("column actual_q_0 read as q.shoulder_pan_joint, ")
    assert note.endswith(", by the order of the joints that were named")


def test_numbers_that_do_not_count_the_joints_are_not_guessed() -> None:
    four = [Column(name=f"q_{k}") for k in range(4)]
    found, notes = settle("a.csv", four, Known(joints=UR))
    assert not found
    assert "it has 4 numbers for 3 joints" in notes[0]
    assert "columns: {q." in notes[0]
    found, notes = settle("a.csv", four, Known(others=UR))
    assert not found
    assert "give 'joints:', in their order" in notes[0]
    assert not read_as("q_0", "q_2", "q_3", joints=UR)


def test_joints_that_are_called_by_numbers_are_no_order() -> None:
    assert read_as("q.1", "2.pos", joints=("1", "2", "3")) == {"q.1": "q.1", "2.pos": "q.2"}
    zero = read_as("actual_q_0", "actual_q_1", "actual_q_2", joints=("1", "2", "3"))
    assert list(zero.values()) == ["q.1", "q.2", "q.3"]


def test_two_columns_for_one_channel_are_named() -> None:
    with pytest.raises(LoadError, match=r"'effort_joint1' and 'torque_joint1' may both be 'tau.j"):
        read_as("effort_joint1", "torque_joint1")
    with pytest.raises(LoadError, match=r"columns: {tau.joint1: \"effort_joint1\"}"):
        read_as("effort_joint1", "torque_joint1")
    both = ("effort_joint1", "torque_joint1")
    assert read_as(*both, ignore=("effort_joint1",)) == {"torque_joint1": "tau.joint1"}
    mapped = read_as(*both, columns={"tau.joint1": "effort_joint1"})
    assert mapped == {"effort_joint1": "tau.joint1"}
    exact = read_as("tau.joint1", "torque_joint1")
    assert exact == {"tau.joint1": "tau.joint1"}
    with pytest.raises(LoadError, match="'t' and 'stamp' may both be 'time'"):
        read_as("t", "stamp")
    assert read_as("__time", "/joint_states/header/stamp") == {"__time": "time"}


def test_the_study_maps_names_and_patterns() -> None:
    names = ["zeit", "m0", "m1", "m2", "Kraft joint1", "Kraft joint2", "enc", "q.joint3", "x"]
    key = {
        "time": "zeit",
        "q_des": "m{index}",
        "tau": "Kraft {joint}",
        "q": {"joint1": "enc"},
        "tip.x": "x",
    }
    assert read_as(*names, columns=key) == {
        "zeit": "time",
        "m0": "q_des.joint1",
        "m1": "q_des.joint2",
        "m2": "q_des.joint3",
        "Kraft joint1": "tau.joint1",
        "Kraft joint2": "tau.joint2",
        "enc": "q.joint1",
        "q.joint3": "q.joint3",
        "x": "tip.x",
    }


def test_a_patterns_index_counts_from_zero_or_one() -> None:
    for first in (0, 1):
        names = [f"enc {k + first}" for k in range(4)]  # the last is of no joint
        read = read_as(*names, columns={"q": "enc {index}"})
        assert list(read.values()) == [f"q.{joint}" for joint in ARM]
        assert list(read) == names[:3]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (["q"], "columns: expected '{q: "),
        ({"qq": "a_{joint}"}, "no channel 'qq'; nearest: 'q'"),
        ({"q": "enc"}, "columns: q: expected a pattern with '{joint}' or '{index}', got 'enc'"),
        ({"q.joint1": 3}, "q.joint1: expected a column's name, got 3"),
        ({"time": "stmp"}, "a.csv: columns: time: no column 'stmp'; nearest: 'stamp'"),
        ({"q": "pos_{joint}"}, "columns: q: no column 'pos_{joint}'; nearest"),
        ({"q.joint1": "q", "q": "{joint}"}, "both mapped to 'q.joint1'"),
    ],
)
def test_what_is_wrong_with_the_key_is_said(columns: Any, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        read_as("stamp", "pos-joint1", "q", "joint1", columns=columns)


def renamed(table: pd.DataFrame, names: dict[str, str]) -> pd.DataFrame:
    return table.rename(columns=names)


def test_a_study_reads_foreign_names_and_says_how(tmp_path: Path) -> None:
    table = renamed(
        log(),
        {
            "time": "Time [ms]",
            "q.elbow": "elbow_pos_deg",
            "q.shoulder": "position.shoulder",
            "dq.elbow": "elbow/velocity",
            "tau.elbow": "effort_elbow",
        },
    )
    table["Time [ms]"] *= 1000
    table["elbow_pos_deg"] *= 180 / np.pi
    study = load_study(write_study(tmp_path, {"a.csv": table}))
    recording = study.fit[0]
    assert recording.period == pytest.approx(0.01)
    assert np.allclose(recording.q, motion(recording.time))
    assert recording.dq is not None
    assert np.allclose(recording.dq, speed(recording.time))
    assert recording.tau is not None
    assert np.isfinite(recording.tau).all()
    notes = "\n".join(study.notes)
    assert (
        "column position.shoulder read as q.shoulder, elbow_pos_deg read as q.elbow in deg" in notes
    )
    assert "elbow/velocity read as dq.elbow" in notes


def test_the_studys_unit_is_believed_before_the_names(tmp_path: Path) -> None:
    table = renamed(log(), {"q.elbow": "elbow_pos_deg", "q.shoulder": "shoulder_pos_deg"})
    units = {"q": "rad"}
    recording = load_study(write_study(tmp_path, {"a.csv": table}, units=units)).fit[0]
    assert np.allclose(recording.q, motion(recording.time))


def test_an_entry_may_have_columns_of_its_own(tmp_path: Path) -> None:
    first = renamed(log(), {"q.elbow": "a", "q.shoulder": "b"})
    second = renamed(log(5.0), {"q.elbow": "c", "q.shoulder": "d"})
    entries = [
        {"file": "a.csv", "role": "fit"},
        {"file": "b.csv", "role": "validate", "columns": {"q": {"elbow": "c", "shoulder": "d"}}},
    ]
    path = write_study(
        tmp_path,
        {"a.csv": first, "b.csv": second},
        recordings=entries,
        columns={"q": {"elbow": "a", "shoulder": "b"}},
    )
    for recording in load_study(path).recordings:
        assert np.allclose(recording.q, motion(recording.time))


def test_without_joints_in_the_study_the_robots_are_looked_for(tmp_path: Path) -> None:
    table = renamed(log(), {f"q.{joint}": f"{joint}_position" for joint in JOINTS})
    study = load_study(write_study(tmp_path, {"a.csv": table}, joints=None))
    assert study.joints == JOINTS
    assert np.allclose(study.fit[0].q, motion(study.fit[0].time))


def test_a_rate_stands_for_times(tmp_path: Path) -> None:
    table = log().drop(columns="time")
    with pytest.raises(LoadError, match=r"expected a column 'time'.*'rate:' \[Hz\]"):
        load_study(write_study(tmp_path, {"a.csv": table}))
    entry = {"file": "a.csv", "rate": 100, "every": 2, "window": [1, 5]}
    recording = load_study(write_study(tmp_path, {"a.csv": table}, recordings=[entry])).fit[0]
    assert recording.period == pytest.approx(0.02)
    assert recording.start == pytest.approx(1.0)
    assert np.allclose(recording.q, motion(recording.time + 1))
    with pytest.raises(LoadError, match="rate: it has times already, in column 'time'"):
        load_study(write_study(tmp_path, {"a.csv": log()}, recordings=[entry]))
