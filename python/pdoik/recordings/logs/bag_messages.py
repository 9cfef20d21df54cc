"""Messages about joints, as samples of `channel.joint`; of any other, its fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdoik._nearest import nearest
from pdoik.errors import LoadError

from ..recording import FloatArray

STATE = "sensor_msgs/msg/JointState"
DYNAMIC = "control_msgs/msg/DynamicJointState"
JTC_STATE = "control_msgs/msg/JointTrajectoryControllerState"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"

STATES = (STATE, DYNAMIC, JTC_STATE)
"""Types of topics that have positions, those that are taken first in front."""
COMMANDS = (STATE, TRAJECTORY, JTC_STATE)

_STATE = {"position": "q", "velocity": "dq", "effort": "tau"}
_COMMAND = {"position": "q_des", "velocity": "dq_des", "effort": "tau_cmd"}
_POINT = {"positions": "q", "velocities": "dq", "effort": "tau"}
_POINT_COMMAND = {"positions": "q_des", "velocities": "dq_des", "effort": "tau_cmd"}

_MOST = 256  # numbers of a field: more are an image

Sample = dict[str, float]


class Topic:
    """Messages of one topic as samples (stamp [ns], {channel.joint: value})."""

    def __init__(self, reader: Any, bag: str, name: str, types: tuple[str, ...] | None) -> None:
        """Find a topic of one of these types, or of any type for None."""
        if name not in reader.topics:
            raise LoadError(f"{bag}: no topic {name!r}{nearest(name, reader.topics)}")
        info = reader.topics[name]
        if types is not None and info.msgtype not in types:
            raise LoadError(
                f"{bag}: topic {name}: expected {' or '.join(types)}, got {info.msgtype}"
            )
        if info.msgtype not in reader.typestore.fielddefs:
            raise LoadError(
                f"{bag}: topic {name}: the bag does not hold the definition of {info.msgtype};"
                " expected one recorded as MCAP, or by ROS 2 Iron or later"
            )
        self.name, self.type, self.count = name, info.msgtype, float(info.msgcount)
        self._reader = reader
        self._connections = [each for each in reader.connections if each.topic == name]

    def samples(self) -> Iterator[tuple[int, Sample]]:
        """What was measured; of a controller's state, its commands as well.

        Of a message that is none of `STATES`, all its numbers by the names of its fields.
        """
        for stamp, message in self._messages():
            if self.type == DYNAMIC:
                yield stamp, _interfaces(message)
            elif self.type == JTC_STATE:
                feedback = _first(message, "feedback", "actual")
                yield stamp, _of(feedback, message.joint_names, _POINT) | _references(message)
            elif self.type == STATE:
                yield stamp, _of(message, message.name, _STATE)
            else:
                yield stamp, dict(_numbers(message, ""))

    def commands(self) -> Iterator[tuple[int, Sample]]:
        """What was commanded; of a trajectory, its points, until the next takes over."""
        waiting: list[tuple[int, Sample]] = []
        for stamp, message in self._messages():
            if self.type == STATE:
                yield stamp, _of(message, message.name, _COMMAND)
            elif self.type == JTC_STATE:
                yield stamp, _references(message)
            else:
                yield from (point for point in waiting if point[0] < stamp)
                waiting = [
                    (
                        stamp + _nanoseconds(each.time_from_start),
                        _of(each, message.joint_names, _POINT_COMMAND),
                    )
                    for each in message.points
                ]
        yield from waiting

    def series(self) -> dict[str, tuple[NDArray[np.int64], FloatArray]]:
        """Stamps [ns] and values of each command, where there is one."""
        found: dict[str, tuple[list[int], list[float]]] = {}
        for stamp, sample in self.commands():
            for column, value in sample.items():
                if np.isfinite(value):
                    stamps, values = found.setdefault(column, ([], []))
                    stamps.append(stamp)
                    values.append(value)
        return {
            column: (np.array(stamps, dtype=np.int64), np.array(values, dtype=np.float64))
            for column, (stamps, values) in found.items()
        }

    def _messages(self) -> Iterator[tuple[int, Any]]:
        for connection, received, raw in self._reader.messages(self._connections):
            message = self._reader.deserialize(raw, connection.msgtype)
            header = getattr(message, "header", None)
            stamped = 0 if header is None else _nanoseconds(header.stamp)
            yield stamped or received, message


def _nanoseconds(time: Any) -> int:
    return int(time.sec) * 1_000_000_000 + int(time.nanosec)


def _of(message: Any, names: Any, fields: Mapping[str, str]) -> Sample:
    """Fields that have a number for each name."""
    sample: Sample = {}
    for field, channel in fields.items():
        values = getattr(message, field)
        if len(values) == len(names):
            for joint, value in zip(names, values, strict=True):
                sample[f"{channel}.{joint}"] = float(value)
    return sample


def _numbers(message: Any, path: str) -> Iterator[tuple[str, float]]:
    """Numbers of a message's fields by their paths: `motor_state.3.q`, `position[3]`."""
    for field in fields(message):
        if field.name in ("header", "__msgtype__"):
            continue
        value = getattr(message, field.name)
        below = f"{path}.{field.name}" if path else field.name
        if is_dataclass(value):
            yield from _numbers(value, below)
        elif isinstance(value, np.ndarray | list) and len(value) <= _MOST:
            for k, each in enumerate(value):
                if is_dataclass(each):
                    yield from _numbers(each, f"{below}.{getattr(each, 'name', None) or k}")
                elif _is_number(each):
                    yield f"{below}[{k}]", float(each)
        elif _is_number(value):
            yield below, float(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _interfaces(message: Any) -> Sample:
    """What each joint's hardware reports in a DynamicJointState, under the interface's name."""
    sample: Sample = {}
    for joint, interfaces in zip(message.joint_names, message.interface_values, strict=False):
        for field, value in zip(interfaces.interface_names, interfaces.values, strict=False):
            sample[f"{_STATE.get(field, field)}.{joint}"] = float(value)
    return sample


def _references(message: Any) -> Sample:
    """Desired joint states and the effort that is put out, of a controller's state."""
    wanted = _of(_first(message, "reference", "desired"), message.joint_names, _POINT_COMMAND)
    output = getattr(message, "output", None)
    if output is not None:
        wanted |= _of(output, message.joint_names, {"effort": "tau_cmd"})
    return wanted


def _first(message: Any, *fields: str) -> Any:
    """The field by its name of today, or by that of earlier versions."""
    there = [getattr(message, field) for field in fields if hasattr(message, field)]
    filled = [each for each in there if len(each.positions)]
    return (filled or there)[0]
