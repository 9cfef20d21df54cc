"""ROS bags and MCAP files as raw columns: joint states, and commands beside them."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdoik.errors import LoadError

from .columns import Table, nearest
from .read_table import Part
from .recording import FloatArray

STATE = "sensor_msgs/msg/JointState"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"

_STATE_FIELDS = {"position": "q", "velocity": "dq", "effort": "tau"}
_COMMAND_FIELDS = {"position": "q_des", "velocity": "dq_des", "effort": "tau_cmd"}
_POINT_FIELDS = {"positions": "q_des", "velocities": "dq_des", "effort": "tau_cmd"}


def read_bag(
    path: Path,
    name: str,
    topic: str | None,
    command_topic: str | None,
    joints: Collection[str] | None,
    part: Part,
) -> Table:
    """Joint states of a ROS 2 bag (folder, .db3, .mcap) or ROS 1 bag, with commands if named.

    position is q, velocity dq, effort tau; of a command topic, q_des, dq_des and tau_cmd, each
    held until the next, on the times of the states. Times are the messages' own stamps, those of
    the recorder where a message has none.

    Args:
        path: Of the bag.
        name: What messages call it.
        topic: Of JointState; the only one there is, otherwise /joint_states.
        command_topic: Of JointState or JointTrajectory.
        joints: Those wanted, all if None.
        part: Which messages.

    Raises:
        LoadError: it is no bag, a topic is missing or of another type, or it is too long.
    """
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    if not path.exists():
        beside = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise LoadError(f"{name}: no such bag: {path}{nearest(path.name, beside)}")
    store = get_typestore(Stores.ROS2_HUMBLE)
    try:
        with AnyReader([path], default_typestore=store) as reader:
            states = _Topic(reader, name, _state_topic(reader, name, topic), (STATE,))
            states.check_size(part)
            stamps, columns = _columns(states.samples(), joints, part)
            if not len(stamps):
                raise LoadError(f"{name}: topic {states.name}: no joint states in it")
            notes = [f"joint states from topic {states.name}"]
            if command_topic is not None:
                commands = _Topic(reader, name, command_topic, (STATE, TRAJECTORY))
                columns |= _held(commands, joints, stamps)
                notes.append(f"commands from topic {command_topic}")
    except (AnyReaderError, OSError, EOFError, AssertionError) as error:
        raise LoadError(f"{name}: cannot be read as a bag: {error}") from error
    time = (stamps - stamps[0]) * 1e-9
    return Table(
        name=name, start=float(stamps[0]) * 1e-9, time=time, columns=columns, notes=tuple(notes)
    )


def _state_topic(reader: Any, name: str, topic: str | None) -> str:
    if topic is not None:
        return topic
    found = sorted(each for each, info in reader.topics.items() if info.msgtype == STATE)
    if len(found) == 1:
        return str(found[0])
    if "/joint_states" in found:
        return "/joint_states"
    if not found:
        there = ", ".join(sorted(reader.topics)) or "none"
        raise LoadError(f"{name}: no topic of type {STATE}; its topics: {there}")
    raise LoadError(
        f"{name}: several topics of type {STATE}: {', '.join(found)}; say which with 'topic:'"
    )


class _Topic:
    """Messages of one topic as samples (stamp [ns], {channel.joint: value})."""

    def __init__(self, reader: Any, bag: str, name: str, types: tuple[str, ...]) -> None:
        if name not in reader.topics:
            raise LoadError(f"{bag}: no topic {name!r}{nearest(name, reader.topics)}")
        info = reader.topics[name]
        if info.msgtype not in types:
            raise LoadError(
                f"{bag}: topic {name}: expected {' or '.join(types)}, got {info.msgtype}"
            )
        self.name, self.type = name, info.msgtype
        self._bag, self._reader, self._count = bag, reader, info.msgcount
        self._connections = [each for each in reader.connections if each.topic == name]

    def check_size(self, part: Part) -> None:
        if part.window is None and self._count / part.every > part.max_rows:
            raise LoadError(
                f"{self._bag}: topic {self.name} has {self._count:,} messages, expected at most"
                f" {part.max_rows:,}; in the study, take a piece with 'window: [0, 600]' [s]"
            )

    def messages(self) -> Iterator[tuple[int, Any]]:
        for connection, received, raw in self._reader.messages(self._connections):
            message = self._reader.deserialize(raw, connection.msgtype)
            stamp = message.header.stamp
            sent = stamp.sec * 1_000_000_000 + stamp.nanosec
            yield sent or received, message

    def samples(
        self, fields: dict[str, str] = _STATE_FIELDS
    ) -> Iterator[tuple[int, dict[str, float]]]:
        """Joint states."""
        for stamp, message in self.messages():
            yield stamp, _sample(message, message.name, fields)

    def points(self) -> Iterator[tuple[int, dict[str, float]]]:
        """Points of trajectories, each at its own time, until the next trajectory takes over."""
        waiting: list[tuple[int, dict[str, float]]] = []
        for stamp, message in self.messages():
            yield from (point for point in waiting if point[0] < stamp)
            waiting = [
                (
                    stamp + each.time_from_start.sec * 1_000_000_000 + each.time_from_start.nanosec,
                    _sample(each, message.joint_names, _POINT_FIELDS),
                )
                for each in message.points
            ]
        yield from waiting


def _sample(message: Any, names: Any, fields: dict[str, str]) -> dict[str, float]:
    sample: dict[str, float] = {}
    for field, channel in fields.items():
        values = getattr(message, field)
        if len(values) == len(names):
            sample |= {
                f"{channel}.{joint}": float(value)
                for joint, value in zip(names, values, strict=True)
            }
    return sample


def _columns(
    samples: Iterator[tuple[int, dict[str, float]]], joints: Collection[str] | None, part: Part
) -> tuple[NDArray[np.int64], dict[str, FloatArray]]:
    """Stamps [ns] and columns of samples, NaN where a sample lacks one."""
    stamps: list[int] = []
    rows: list[dict[str, float]] = []
    first = None
    for k, (stamp, sample) in enumerate(samples):
        mine = {
            column: value
            for column, value in sample.items()
            if joints is None or column.partition(".")[2] in joints
        }
        first = stamp if first is None else first
        since = (stamp - first) * 1e-9
        outside = part.window is not None and not part.window[0] <= since <= part.window[1]
        if mine and k % part.every == 0 and not outside and len(rows) <= part.max_rows:
            stamps.append(stamp)
            rows.append(mine)
    names = list(dict.fromkeys(column for row in rows for column in row))
    columns = {
        name: np.array([row.get(name, np.nan) for row in rows], dtype=np.float64) for name in names
    }
    return np.array(stamps, dtype=np.int64), columns


def _held(
    topic: _Topic, joints: Collection[str] | None, at: NDArray[np.int64]
) -> dict[str, FloatArray]:
    """A command topic's columns at the times of the states: several points to a line between."""
    points = topic.type == TRAJECTORY
    samples = topic.points() if points else topic.samples(_COMMAND_FIELDS)
    stamps, columns = _columns(samples, joints, Part())
    held = {}
    for name, values in columns.items():
        there = np.isfinite(values)
        t, x = stamps[there], values[there]
        if points:
            held[name] = np.where(at < t[0], np.nan, np.interp(at - t[0], t - t[0], x))
        else:
            index = np.searchsorted(t, at, side="right") - 1
            held[name] = np.where(index < 0, np.nan, x[np.maximum(index, 0)])
    return held
