"""What ros2_control publishes is read from bags that rosbags' own writer made."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import Recording
from pdoik.sim2real.study import load_study
from studies import JOINTS, motion, speed, write_study

pytest.importorskip("rosbags")

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

BEGUN = 1_700_000_000_000_000_000  # [ns]
NAMES = JOINTS[::-1]
JTC = "control_msgs/msg/JointTrajectoryControllerState"
DYNAMIC = "control_msgs/msg/DynamicJointState"
POINT = "trajectory_msgs/JointTrajectoryPoint"
HEAD = "std_msgs/Header header\nstring[] joint_names\n"


def store(*fields: str) -> Any:
    """Message types, with a controller's state that has these fields."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in (
        (JTC, HEAD + "".join(f"{POINT} {field}\n" for field in fields)),
        ("control_msgs/msg/InterfaceValue", "string[] interface_names\nfloat64[] values\n"),
        (DYNAMIC, HEAD + "control_msgs/InterfaceValue[] interface_values\n"),
    ):
        types.register(get_types_from_msg(text, name))
    return types


NEW = store("reference", "feedback", "error", "output")
OLD = store("desired", "actual", "error")


def header(types: Any, stamp: int) -> Any:
    time = types.types["builtin_interfaces/msg/Time"]
    return types.types["std_msgs/msg/Header"](
        stamp=time(sec=stamp // 1_000_000_000, nanosec=stamp % 1_000_000_000), frame_id=""
    )


def point(types: Any, **values: Any) -> Any:
    none = {f: np.empty(0) for f in ("positions", "velocities", "accelerations", "effort")}
    zero = types.types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
    given = {field: np.array(value, dtype=np.float64) for field, value in values.items()}
    kind = types.types["trajectory_msgs/msg/JointTrajectoryPoint"]
    return kind(**none | given, time_from_start=zero)


def at(k: int) -> tuple[int, np.ndarray, np.ndarray]:
    """Stamp, positions and speeds in the controller's order of joints."""
    t = np.array([k * 0.01])
    return BEGUN + k * 10_000_000, motion(t)[0, ::-1].copy(), speed(t)[0, ::-1].copy()


def controller_state(types: Any, k: int) -> tuple[int, Any]:
    stamp, q, dq = at(k)
    wanted, got = ("reference", "feedback") if types is NEW else ("desired", "actual")
    parts = {
        wanted: point(types, positions=q + 0.01, velocities=dq + 0.02),
        got: point(types, positions=q, velocities=dq),
        "error": point(types, positions=[0.01, 0.01], velocities=[0.02, 0.02]),
    }
    if types is NEW:
        parts["output"] = point(types, effort=[3.0, k])
    message = types.types[JTC](header=header(types, stamp), joint_names=list(NAMES), **parts)
    return stamp, message


def dynamic_state(types: Any, k: int) -> tuple[int, Any]:
    stamp, q, dq = at(k)
    value = types.types["control_msgs/msg/InterfaceValue"]
    values = [
        value(
            interface_names=["velocity", "position", "motor_temperature", "current"],
            values=np.array([dq[j], q[j], 40.0, 1.0 + j + 0.01 * q[j]]),
        )
        for j in range(2)
    ]
    hand = value(interface_names=["open"], values=np.ones(1))
    return stamp, types.types[DYNAMIC](
        header=header(types, stamp),
        joint_names=[*NAMES, "hand"],
        interface_values=[*values, hand],
    )


def joint_state(types: Any, k: int) -> tuple[int, Any]:
    stamp, q, _ = at(k)
    kind = types.types["sensor_msgs/msg/JointState"]
    message = kind(
        header=header(types, stamp),
        name=list(NAMES),
        position=q,
        velocity=np.empty(0),
        effort=np.empty(0),
    )
    return stamp, message


def write_bag(
    path: Path,
    topics: dict[str, Callable[[Any, int], tuple[int, Any]]],
    types: Any = NEW,
    plugin: StoragePlugin = StoragePlugin.MCAP,
) -> None:
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        for name, make in topics.items():
            kind = make(types, 0)[1].__msgtype__
            connection = writer.add_connection(name, kind, typestore=types)
            for k in range(800):
                stamp, message = make(types, k)
                writer.write(connection, stamp, types.serialize_cdr(message, kind))


def loaded(folder: Path, **entry: Any) -> Recording:
    return load_study(write_study(folder, {}, recordings=[{"file": "bag", **entry}])).fit[0]


@pytest.mark.parametrize("types", [NEW, OLD], ids=["reference", "desired"])
@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_controllers_state_has_what_was_measured_and_wanted(
    tmp_path: Path, types: Any, plugin: StoragePlugin
) -> None:
    write_bag(tmp_path / "bag", {"/arm/controller_state": controller_state}, types, plugin)
    recording = loaded(tmp_path)
    assert np.allclose(recording.q, motion(recording.time))
    assert recording.dq is not None
    assert np.allclose(recording.dq, speed(recording.time))
    assert recording.q_des is not None
    assert np.allclose(recording.q_des, recording.q + 0.01)
    assert recording.dq_des is not None
    assert np.allclose(recording.dq_des, recording.dq + 0.02)
    assert recording.tau is None
    if types is NEW:
        assert recording.tau_cmd is not None
        rows = np.arange(len(recording.time))
        assert np.allclose(recording.tau_cmd, np.stack([rows, np.full_like(rows, 3)], axis=1))
    else:
        assert recording.tau_cmd is None


def test_dynamic_states_have_what_the_hardware_tells(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", {"/dynamic_joint_states": dynamic_state})
    recording = loaded(tmp_path)
    assert recording.channels == ("q", "dq", "current")
    assert np.allclose(recording.q, motion(recording.time))
    assert recording.current is not None
    assert np.allclose(recording.current, [2, 1] + 0.01 * recording.q)


def test_joint_states_come_first_and_references_beside_them(tmp_path: Path) -> None:
    topics = {
        "/joint_states": joint_state,
        "/dynamic_joint_states": dynamic_state,
        "/arm/controller_state": controller_state,
    }
    write_bag(tmp_path / "bag", topics)
    recording = loaded(tmp_path)
    assert recording.channels == ("q",)
    notes = "\n".join(recording.notes)
    assert "joint states from topic /joint_states" in notes
    assert "they are read with 'command_topic: /arm/controller_state'" in notes
    recording = loaded(tmp_path, command_topic="/arm/controller_state")
    assert recording.channels == ("q", "q_des", "dq_des", "tau_cmd")
    assert recording.q_des is not None
    assert np.allclose(recording.q_des, recording.q + 0.01)


def test_a_part_of_a_bag(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", {"/joint_states": joint_state})
    recording = loaded(tmp_path, window=[2, 7], every=2)
    assert recording.start == pytest.approx(BEGUN * 1e-9 + 2)
    assert recording.period == pytest.approx(0.02)
    assert np.allclose(recording.q, motion(recording.time + 2))


def test_a_bag_whose_recorder_died_is_its_file(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", {"/joint_states": joint_state})
    (tmp_path / "bag/metadata.yaml").unlink()
    assert np.allclose(loaded(tmp_path).q[0], motion(np.zeros(1)))
    (tmp_path / "bag/more.mcap").write_bytes(b"")
    with pytest.raises(LoadError, match=r"no metadata.yaml; expected it, or one of its files: "):
        loaded(tmp_path)


def test_a_type_that_the_bag_does_not_define_is_said(tmp_path: Path) -> None:
    """SQLite bags of ROS 2 Humble and before hold no definitions."""
    import sqlite3

    write_bag(
        tmp_path / "bag",
        {"/arm/controller_state": controller_state},
        plugin=StoragePlugin.SQLITE3,
    )
    (file,) = (tmp_path / "bag").glob("*.db3")
    with sqlite3.connect(file) as database:
        database.execute("DELETE FROM message_definitions")
        database.execute("UPDATE topics SET type_description_hash = ''")
    database.close()
    with pytest.raises(LoadError, match=r"bag: .*definition.* of control_msgs"):
        loaded(tmp_path)
