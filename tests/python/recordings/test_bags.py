"""Joint states come from real ROS 2 bags and MCAP files, written by rosbags' own writer."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdoik.errors import LoadError
from pdoik.sim2real.study import load_study
from studies import JOINTS, log, motion, speed, write_study

pytest.importorskip("rosbags")

from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
STATE = "sensor_msgs/msg/JointState"
BEGUN = 1_700_000_000_000_000_000  # [ns]
NAMES = ("elbow", "shoulder", "gripper")  # as controllers order them: by the alphabet or not


def header(stamp: int) -> Any:
    time = STORE.types["builtin_interfaces/msg/Time"]
    return STORE.types["std_msgs/msg/Header"](
        stamp=time(sec=stamp // 1_000_000_000, nanosec=stamp % 1_000_000_000), frame_id=""
    )


def state(
    stamp: int,
    names: Sequence[str],
    position: Sequence[float],
    velocity: Sequence[float] = (),
    effort: Sequence[float] = (),
) -> Any:
    return STORE.types[STATE](
        header=header(stamp),
        name=list(names),
        position=np.array(position, dtype=np.float64),
        velocity=np.array(velocity, dtype=np.float64),
        effort=np.array(effort, dtype=np.float64),
    )


def write_bag(path: Path, topics: dict[str, list[tuple[int, Any]]], plugin: StoragePlugin) -> None:
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        for name, messages in topics.items():
            kind = messages[0][1].__msgtype__
            connection = writer.add_connection(name, kind, typestore=STORE)
            for received, message in messages:
                writer.write(connection, received, STORE.serialize_cdr(message, kind))


def states(stamped: bool = True) -> list[tuple[int, Any]]:
    """A state each 10 ms, received 3 ms later."""
    messages = []
    for k in range(800):
        t, stamp = np.array([k * 0.01]), BEGUN + k * 10_000_000
        q, dq = motion(t)[0], speed(t)[0]
        message = state(stamp if stamped else 0, NAMES, [q[1], q[0], 0.3], [dq[1], dq[0], 0.0])
        messages.append((stamp + 3_000_000, message))
    return messages


@pytest.mark.parametrize("plugin", list(StoragePlugin))
@pytest.mark.parametrize("bare", [False, True])
def test_joint_states_of_a_bag(tmp_path: Path, plugin: StoragePlugin, bare: bool) -> None:
    write_bag(tmp_path / "bag", {"/joint_states": states()}, plugin)
    suffix = "mcap" if plugin == StoragePlugin.MCAP else "db3"
    file = next((tmp_path / "bag").glob(f"*.{suffix}")).relative_to(tmp_path) if bare else "bag"
    path = write_study(tmp_path, {"b.csv": log()}, recordings=[str(file), "b.csv"], joints=None)
    study = load_study(path)
    assert study.joints == JOINTS
    recording = study.fit[0]
    assert recording.name == (Path(file).name)
    assert recording.start == pytest.approx(BEGUN * 1e-9, abs=1e-6)
    assert recording.channels == ("q", "dq")
    assert recording.dq is not None
    assert np.allclose(recording.q, motion(recording.time))
    assert np.allclose(recording.dq, speed(recording.time))
    assert recording.period == pytest.approx(0.01)


def test_a_state_without_a_stamp_has_the_recorders(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", {"/arm/state": states(stamped=False)}, StoragePlugin.MCAP)
    recording = load_study(write_study(tmp_path, {}, recordings=["bag"])).fit[0]
    assert recording.start == pytest.approx((BEGUN + 3_000_000) * 1e-9, abs=1e-6)


def test_commands_of_another_topic_are_held(tmp_path: Path) -> None:
    commands = [
        (BEGUN + k * 100_000_000, state(BEGUN + k * 100_000_000, JOINTS, [k, -k], (), [2 * k, 0]))
        for k in range(1, 80)
    ]
    write_bag(
        tmp_path / "bag",
        {"/joint_states": states(), "/command": commands},
        StoragePlugin.SQLITE3,
    )
    entry = {"file": "bag", "command_topic": "/command"}
    recording = load_study(
        write_study(
            tmp_path, {"b.csv": log()}, recordings=[entry, {"file": "b.csv", "role": "validate"}]
        )
    ).fit[0]
    assert recording.q_des is not None
    assert recording.tau_cmd is not None
    count = np.floor(recording.time / 0.1 + 1e-6)
    assert np.array_equal(recording.q_des[10:, 0], count[10:])
    assert np.array_equal(recording.q_des[10:, 1], -count[10:])
    assert np.array_equal(recording.tau_cmd[10:, 0], 2 * count[10:])
    assert not recording.valid[:9].any()  # no command yet


def test_a_trajectory_is_a_line_between_its_points_until_the_next(tmp_path: Path) -> None:
    point = STORE.types["trajectory_msgs/msg/JointTrajectoryPoint"]
    wait = STORE.types["builtin_interfaces/msg/Duration"]
    none = np.empty(0)

    def trajectory(stamp: int, ends: list[tuple[int, float]]) -> tuple[int, Any]:
        points = [
            point(
                positions=np.array([value, 0.0]),
                velocities=none,
                accelerations=none,
                effort=none,
                time_from_start=wait(sec=after, nanosec=0),
            )
            for after, value in ends
        ]
        kind = STORE.types["trajectory_msgs/msg/JointTrajectory"]
        message = kind(header=header(stamp), joint_names=list(JOINTS), points=points)
        return stamp, message

    sent = [
        trajectory(BEGUN, [(0, 0.0), (2, 1.0), (60, 9.0)]),
        trajectory(BEGUN + 4_000_000_000, [(0, 5.0), (2, 6.0), (4, 6.0)]),
    ]
    write_bag(tmp_path / "bag", {"/joint_states": states(), "/go": sent}, StoragePlugin.MCAP)
    entry = {"file": "bag", "command_topic": "/go"}
    q_des = (
        load_study(
            write_study(
                tmp_path,
                {"b.csv": log()},
                recordings=[entry, {"file": "b.csv", "role": "validate"}],
            )
        )
        .fit[0]
        .q_des
    )
    assert q_des is not None
    assert q_des[100, 0] == pytest.approx(0.5)
    assert q_des[500, 0] == pytest.approx(5.5)
    assert q_des[700, 0] == pytest.approx(6.0)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({"file": "nobag"}, "no such file: .*nobag; nearest: 'bag'"),
        (
            {"file": "bag", "topic": "/left/state"},
            "no topic '/left/state'; nearest: '/left/states'",
        ),
        ({"file": "bag"}, "several topics of type .*: /left/states, /right/states; say which"),
        (
            {"file": "bag", "topic": "/words"},
            "topic /words: expected joint .* none in its std_msgs",
        ),
        ({"file": "empty"}, "empty: a folder in which nothing is known; expected a bag"),
        ({"file": "broken.mcap"}, "cannot be read as a bag"),
        (
            {"file": "bag", "topic": "/left/states", "every": 1},
            "about 800 rows, expected at most 700",
        ),
    ],
)
def test_what_is_wrong_with_a_bag_is_said(
    tmp_path: Path, entry: dict[str, Any], message: str
) -> None:
    word = STORE.types["std_msgs/msg/String"](data="hello")
    write_bag(
        tmp_path / "bag",
        {"/left/states": states(), "/right/states": states(), "/words": [(BEGUN, word)]},
        StoragePlugin.MCAP,
    )
    (tmp_path / "empty").mkdir()
    (tmp_path / "broken.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(100))
    with pytest.raises(LoadError, match=message):
        load_study(write_study(tmp_path, {}, recordings=[entry], max_rows=700))


LOW_STATE = """uint32 tick
Motor[3] motor_state
================================================================================
MSG: maker_msgs/msg/Motor
uint8 mode
float32 q
float32 dq
float32 tau_est
"""


def test_fields_of_any_other_topic_are_columns(tmp_path: Path) -> None:
    """A maker's own message, without a header, whose motors are counted."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(LOW_STATE, "maker_msgs/msg/LowState"))
    low, motor = (store.types[f"maker_msgs/msg/{each}"] for each in ("LowState", "Motor"))
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/lowstate", low.__msgtype__, typestore=store)
        for k in range(800):
            t = np.array([k * 0.01])
            q, dq = motion(t)[0], speed(t)[0]
            rows = [(q[0], dq[0], 2.0 * q[0]), (q[1], dq[1], 2.0 * q[1]), (0.0, 0.0, 0.0)]
            motors = [motor(mode=1, q=a, dq=b, tau_est=c) for a, b, c in rows]
            message = low(tick=10 * k, motor_state=motors)
            raw = store.serialize_cdr(message, low.__msgtype__)
            writer.write(connection, BEGUN + k * 10_000_000, raw)
    untold = write_study(tmp_path, {"b.csv": log()}, recordings=["bag", "b.csv"])
    with pytest.raises(LoadError, match="'topic:' reads the fields of any other"):
        load_study(untold)
    columns = {"q": "motor_state.{index}.q", "dq": "motor_state.{index}.dq"}
    entry = {"file": "bag", "topic": "/lowstate", "columns": columns}
    path = write_study(tmp_path, {"b.csv": log()}, recordings=[entry, "b.csv"])
    recording = load_study(path).recordings[0]
    assert recording.raw_period == pytest.approx(0.01)
    at = recording.time - recording.time[0]
    inside = slice(20, 300)
    assert recording.q[inside] == pytest.approx(motion(at[inside]), abs=2e-3)
