"""A log of any kind is arrays with names, units and a clock, without a study."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pdoik import recordings
from pdoik.errors import LoadError
from pdoik.recordings import RobotLog, SuspectedUnitError, Unit, read_log
from studies import JOINTS, MJCF, URDF, columns, log, motion, speed

TIME = np.arange(800) / 100
BEGUN = 1_700_000_000  # [s]


def stacked(channel: str) -> np.ndarray:
    return np.stack([columns(TIME)[f"{channel}.{joint}"] for joint in JOINTS], axis=1)


def write_csv(folder: Path) -> Path:
    log().to_csv(folder / "a.csv", index=False)
    return folder / "a.csv"


def write_parquet(folder: Path) -> Path:
    log().to_parquet(folder / "a.parquet")
    return folder / "a.parquet"


def write_npz(folder: Path) -> Path:
    arrays = {"t": TIME, "joint_names": np.array(JOINTS)}
    np.savez(folder / "a.npz", q=stacked("q"), dq=stacked("dq"), tau=stacked("tau"), **arrays)
    return folder / "a.npz"


def write_hdf5(folder: Path) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(folder / "a.h5", "w") as file:
        file["t"] = TIME
        for channel in ("q", "dq", "tau"):
            file[channel] = stacked(channel)
        file.attrs["joint_names"] = list(JOINTS)
    return folder / "a.h5"


def write_matlab(folder: Path) -> Path:
    scipy_io = pytest.importorskip("scipy.io")
    content = {channel: stacked(channel) for channel in ("q", "dq", "tau")}
    names = np.array(JOINTS, dtype=object)
    scipy_io.savemat(folder / "a.mat", {"t": TIME, "joint_names": names, **content})
    return folder / "a.mat"


def write_json_lines(folder: Path) -> Path:
    rows = (
        {"t": t, "name": list(JOINTS), "position": q, "velocity": dq, "effort": tau}
        for t, q, dq, tau in zip(
            TIME.tolist(), *(stacked(c).tolist() for c in ("q", "dq", "tau")), strict=True
        )
    )
    (folder / "a.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder / "a.jsonl"


def write_bag(folder: Path, storage: str) -> Path:
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kind = "sensor_msgs/msg/JointState"
    with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin[storage]) as writer:
        topic = writer.add_connection("/joint_states", kind, typestore=store)
        every = zip(TIME, *(stacked(c) for c in ("q", "dq", "tau")), strict=True)
        for t, q, dq, tau in every:
            nanoseconds = round(t * 1e9)
            stamp = store.types["builtin_interfaces/msg/Time"](
                sec=BEGUN + nanoseconds // 10**9, nanosec=nanoseconds % 10**9
            )
            header = store.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
            message = store.types[kind](header, list(JOINTS), q.copy(), dq.copy(), tau.copy())
            received = BEGUN * 10**9 + nanoseconds + 3_000_000
            writer.write(topic, received, store.serialize_cdr(message, kind))
    return folder / "bag"


def write_lerobot(folder: Path) -> Path:
    root = folder / "lerobot"
    (root / "meta").mkdir(parents=True)
    (root / "data/chunk-000").mkdir(parents=True)
    joints = [f"{joint}.pos" for joint in JOINTS]
    feature = {"dtype": "float32", "shape": [len(JOINTS)], "names": joints}
    info = {
        "fps": 100,
        "features": {"observation.state": feature, "action": feature},
        "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        "total_episodes": 1,
    }
    (root / "meta/info.json").write_text(json.dumps(info))
    frames = {
        "observation.state": stacked("q").tolist(),
        "action": stacked("q").tolist(),
        "frame_index": range(len(TIME)),
        "episode_index": 0,
    }
    pd.DataFrame(frames).to_parquet(root / "data/chunk-000/episode_000000.parquet")
    return root


WRITERS: dict[str, Callable[[Path], Path]] = {
    "CSV": write_csv,
    "Parquet": write_parquet,
    "NPZ": write_npz,
    "HDF5": write_hdf5,
    "MATLAB": write_matlab,
    "JSON lines": write_json_lines,
    "MCAP": lambda folder: write_bag(folder, "MCAP"),
    "SQLite": lambda folder: write_bag(folder, "SQLITE3"),
    "LeRobot": write_lerobot,
}


@pytest.mark.parametrize("kind", WRITERS)
def test_each_kind_is_the_same_arrays(tmp_path: Path, kind: str) -> None:
    read = read_log(WRITERS[kind](tmp_path))
    assert read.names == JOINTS
    assert np.allclose(read.time, TIME, atol=1e-6)
    assert np.allclose(read.q, motion(TIME), atol=1e-6)
    assert read.start == pytest.approx(BEGUN if kind in ("MCAP", "SQLite") else 0.0)
    assert read.clock.period == pytest.approx(0.01, abs=1e-6)
    assert read.clock.since_1970 == (kind in ("MCAP", "SQLite"))
    assert read.clock.repeated == read.clock.backwards == 0
    if kind == "LeRobot":
        assert read.channels == ("q", "q_des")
        assert read.dq is None
    else:
        assert read.channels == ("q", "dq", "tau")
        assert np.allclose(read.dq, speed(TIME), atol=1e-6)
        assert np.allclose(read.tau, stacked("tau"), atol=1e-6)
    assert not read.suspected
    assert np.allclose(read.recording().q, motion(read.recording().time), atol=1e-5)


def of_csv(folder: Path, table: dict[str, Any], **how: Any) -> RobotLog:
    pd.DataFrame(table).to_csv(folder / "a.csv", index=False)
    return read_log(folder / "a.csv", **how)


def test_arrays_are_in_si_and_units_say_from_what(tmp_path: Path) -> None:
    q = motion(TIME)
    table = {
        "Time [ms]": 1000 * TIME,
        "joint1_pos [deg]": np.degrees(q[:, 0]),
        "joint2_pos [deg]": np.degrees(q[:, 1]),
        "joint1_torque": 1000 * q[:, 0],
        "joint2_torque": q[:, 1],
        "temperature": 30.0,
    }
    read = of_csv(tmp_path, table, units={"tau.joint1": "mN.m"})
    assert read.names == ("joint1", "joint2")
    assert np.allclose(read.q, q)
    assert np.allclose(read.tau, q)
    assert read.units["q"] == Unit(si="rad", logged="deg", source="log")
    assert read.units["tau.joint1"] == Unit(si="N.m", logged="mN.m", source="named")
    assert read.units["tau.joint2"] == Unit(si="N.m", logged="N.m", source="assumed")
    assert read.clock.source == "column 'Time [ms]' in ms"
    assert read.unread == ("temperature",)
    said = str(read)
    assert said.startswith("a.csv: 800 rows in 7.99 s, joints joint1, joint2\n")
    assert "  q [rad]: logged in deg, as the log says\n" in said
    assert said.endswith("not read: temperature")


def test_a_slide_is_in_metres(tmp_path: Path) -> None:
    robot = URDF.format(mass=1).replace('"elbow" type="revolute"', '"elbow" type="prismatic"')
    (tmp_path / "arm.urdf").write_text(robot)
    table = {"time": TIME, "q.shoulder": np.degrees(TIME), "q.elbow": TIME / 100}
    read = of_csv(tmp_path, table, robot=tmp_path / "arm.urdf", units={"q": "deg"})
    assert read.q is not None
    assert np.allclose(read.q, np.stack([TIME, TIME / 100], axis=1))
    assert {name: unit.si for name, unit in read.units.items()} == {
        "q.shoulder": "rad",
        "q.elbow": "m",
    }


def test_units_that_numbers_look_like_are_said_and_not_taken(tmp_path: Path) -> None:
    q, dq = np.degrees(motion(TIME)), np.degrees(speed(TIME))
    table = {"time": TIME}
    for k in range(2):
        table |= {f"q.j{k}": q[:, k], f"dq.j{k}": dq[:, k]}
    read = of_csv(tmp_path, table)
    assert np.allclose(read.q, q)
    assert {each.channel: each.suspected for each in read.suspected} == {"q": "deg", "dq": "deg/s"}
    assert "suspected: a.csv: is 'q' in deg? Expected rad, but" in str(read)
    with pytest.raises(SuspectedUnitError, match=r"Say which it is: 'units: \{q: deg\}'"):
        read.recording(ask=True)
    named = {each.channel: each.suspected for each in read.suspected}
    again = read_log(tmp_path / "a.csv", units=named)
    assert np.allclose(again.q, motion(TIME))
    assert not again.suspected


def test_joints_that_nobody_names_are_numbered_and_it_is_said(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=TIME, qpos=motion(TIME), ctrl=motion(TIME), x=TIME)
    read = read_log(tmp_path / "a.npz")
    assert read.names == ("joint1", "joint2")
    assert np.allclose(read.q, motion(TIME))
    assert any("their order in the log, which names no joints" in note for note in read.notes)
    assert read_log(tmp_path / "a.npz", joints=JOINTS).names == JOINTS
    assert np.allclose(read_log(tmp_path / "a.npz", joints=JOINTS).q, read.q)
    assert read_log(tmp_path / "a.npz", numbered=False).names == ()


def test_numbers_in_names_are_kept(tmp_path: Path) -> None:
    q = motion(TIME)
    read = of_csv(tmp_path, {"t": TIME, "pos_0": q[:, 0], "pos_1": q[:, 1]})
    assert read.names == ("joint0", "joint1")


def test_series_of_other_lengths_are_not_guessed(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=TIME, q=motion(TIME), tau=np.ones((800, 3)))
    read = read_log(tmp_path / "a.npz")
    assert read.names == ("joint1", "joint2")
    assert read.tau is None
    assert any("tau not read: its 3 numbers are of no named joints" in note for note in read.notes)


def test_one_servo_needs_no_names(tmp_path: Path) -> None:
    q = motion(TIME)[:, 0]
    table = {"time": TIME, "position": q, "goal position": q + 0.1, "velocity": 0 * q, "volts": 12}
    read = of_csv(tmp_path, table)
    assert read.names == ("joint1",)
    assert read.channels == ("q", "dq", "q_des")
    assert np.allclose(read.q[:, 0], q)
    assert np.allclose(read.supply, 12.0)


def test_a_robot_tells_addresses_of_state_vectors(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(MJCF.format(mass=1))
    np.savez(tmp_path / "a.npz", time=TIME, qpos=motion(TIME), qvel=speed(TIME))
    read = read_log(tmp_path / "a.npz", robot=tmp_path / "arm.xml")
    assert read.names == JOINTS
    assert np.allclose(read.dq, speed(TIME))


def test_joints_that_the_robot_has_not_are_left_out_and_said(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF.format(mass=1))
    robot = tmp_path / "arm.urdf"
    table = {"time": TIME, "q.elbow": TIME / 4, "q.wheel": TIME}
    read = of_csv(tmp_path, table, robot=robot)
    assert (read.names, read.notes) == (("elbow",), ("not joints of the robot: wheel",))
    assert not read.suspected
    with pytest.raises(LoadError, match="the robot has no joint 'elbw' that moves; nearest: 'elb"):
        of_csv(tmp_path, table, robot=robot, joints=["elbw"])
    read = of_csv(tmp_path, {"time": TIME, "q.wheel": TIME}, robot=robot)
    assert (read.names, read.robot) == (("wheel",), None)
    assert np.allclose(read.q[:, 0], TIME)


def test_rows_are_as_logged_and_a_recording_is_mended(tmp_path: Path) -> None:
    q = motion(TIME)[:, 0].copy()
    q[100] += 1.0
    read = of_csv(tmp_path, {"time": TIME, "q.a": q})
    assert read.q[100, 0] == pytest.approx(q[100])
    recording = read.recording()
    assert recording.q[100, 0] == pytest.approx(motion(TIME)[100, 0], abs=1e-3)
    assert any("left out" in note for note in recording.notes)


def test_the_clock_says_what_is_odd(tmp_path: Path) -> None:
    time = TIME.copy()
    time[10], time[20] = time[9], time[18]
    read = of_csv(tmp_path, {"time": time, "q.a": motion(TIME)[:, 0]})
    assert (read.clock.repeated, read.clock.backwards) == (1, 1)
    assert "1 go back in time" in str(read)
    with pytest.raises(LoadError, match="time runs backwards"):
        read.recording()
    assert not read.suspected


def test_parts_and_rates(tmp_path: Path) -> None:
    write_csv(tmp_path)
    read = read_log(tmp_path / "a.csv", window=(1.0, 3.0), every=2)
    assert (read.start, len(read.time)) == (1.0, 101)
    table = {"q.a": motion(TIME)[:, 0]}
    with pytest.raises(LoadError, match=r"expected a column 'time' .* or 'rate:' \[Hz\]"):
        of_csv(tmp_path, table)
    read = of_csv(tmp_path, table, rate=100)
    assert np.allclose(read.time, TIME)
    assert read.clock.source == "100 rows a second"


def test_columns_are_mapped(tmp_path: Path) -> None:
    q = motion(TIME)
    table = {"stamp": TIME, "enc_1": q[:, 0], "enc_2": q[:, 1], "motor 2 Nm": TIME}
    read = of_csv(
        tmp_path,
        table,
        joints=JOINTS,
        columns={"q": "enc_{index}", "tau": {"elbow": "motor 2 Nm"}, "time": "stamp"},
    )
    assert np.allclose(read.q, q)
    assert np.isnan(read.tau[:, 0]).all()
    assert np.allclose(read.tau[:, 1], TIME)


def test_poses_and_imus_are_channels(tmp_path: Path) -> None:
    pose = {f"tip.{part}": 1000.0 * (part == "x") for part in ("x", "y", "z")}
    imu = {f"gyro.{axis}": TIME for axis in "xyz"}
    table = {"time": TIME, "q.a": TIME, **pose, **imu, "contact.foot": 1.0}
    read = of_csv(tmp_path, table, units={"tip": "mm"})
    assert read.channels == ("q", "tip", "gyro")
    assert read.array("tip")[:, 0] == pytest.approx(1.0)
    assert np.isnan(read.array("tip")[:, 3:]).all()
    assert read.array("gyro").shape == (800, 3)
    assert read.array("acc") is None
    assert list(read.contacts) == ["foot"]
    with pytest.raises(ValueError, match="no channel 'torque'"):
        read.array("torque")


@pytest.mark.parametrize(
    ("how", "error", "message"),
    [
        ({"episode": 1}, LoadError, "episode: is of a LeRobot data set only, this file is CSV"),
        ({"tpic": "/a"}, TypeError, "read_log has no argument 'tpic'; nearest: 'topic'"),
        ({"units": {"q": "furlong"}}, LoadError, "a.csv: units: q: no unit 'furlong'"),
        ({"columns": {"qq": "a"}}, LoadError, "a.csv: columns: no channel 'qq'; nearest: 'q"),
        ({"columns": {"q.a": "b"}}, LoadError, "a.csv: columns: q.a: no column 'b'"),
        ({"robot": "gone.urdf"}, LoadError, "no such file: gone.urdf"),
        ({"max_rows": 10}, LoadError, r"about .* rows, expected at most 10; .*'window: "),
    ],
)
def test_what_is_wrong_is_said(
    tmp_path: Path, how: dict[str, Any], error: type[Exception], message: str
) -> None:
    write_csv(tmp_path)
    with pytest.raises(error, match=message):
        read_log(tmp_path / "a.csv", **how)


def test_no_file_names_the_nearest(tmp_path: Path) -> None:
    write_csv(tmp_path)
    with pytest.raises(LoadError, match=r"no such file: .*b\.csv; nearest: 'a\.csv'"):
        read_log(tmp_path / "b.csv")


def test_every_name_of_the_face_is_there_and_none_needs_the_diagnosis() -> None:
    for name in recordings.__all__:
        assert getattr(recordings, name) is not None, name
    program = (
        "import sys, pdoik; log = pdoik.recordings;"
        "assert not {'scipy', 'pyarrow', 'h5py'} & {*sys.modules};"
        "log.read_log; assert 'pdoik.sim2real' not in sys.modules; assert 'pyarrow' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize(
    ("names", "joints"),
    [
        (
            ("shoulder_pan_pos", "elbow_pos", "shoulder_pan_vel", "elbow_vel"),
            ("shoulder_pan", "elbow"),
        ),
        (
            ("/joint_states/FL_hip/position", "/joint_states/FL_calf/position"),
            ("FL_hip", "FL_calf"),
        ),
        (("position.shoulder", "position.elbow", "effort.elbow"), ("shoulder", "elbow")),
        (
            ("panda_joint1 angle [deg]", "panda_joint2 angle [deg]"),
            ("panda_joint1", "panda_joint2"),
        ),
        (("actual_q_left_2", "actual_q_right_2", "cpu_current"), ("left_2", "right_2")),
        (("joint1_pos", "joint2_pos"), ("joint1", "joint2")),
    ],
)
def test_joints_names_are_found_in_those_of_columns(
    tmp_path: Path, names: tuple[str, ...], joints: tuple[str, ...]
) -> None:
    read = of_csv(tmp_path, {"t": TIME, **dict.fromkeys(names, TIME)})
    assert read.names == joints
    assert not np.isnan(read.q).any()
    assert not set(read.unread) - {"cpu_current"}
