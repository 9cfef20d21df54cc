"""ROS bags and MCAP files: joint states of ROS and of ros2_control, and commands with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from pdoik.errors import LoadError

from ..key import Key, Keys
from ..recording import FloatArray
from .bag_messages import COMMANDS, JTC_STATE, STATES, TRAJECTORY, Topic
from .kinds import register
from .log import Column, Log

_PEEKED = 500  # messages in which the joints' names are looked for: several nodes may publish
_PIECE = 4096  # rows at a time


@register
class Bag(Log):
    """A ROS 2 bag (folder, .db3, .mcap) or ROS 1 bag.

    A topic of any other type, where it is given, has the numbers of its fields as columns. Times
    are the messages' own stamps, those of the recorder where a message has none. Commands
    are held until the next, points of a trajectory are joined by lines, on the times of the states.
    """

    kind = "a ROS bag"
    suffixes = (".mcap", ".db3", ".bag")
    magic = (b"\x89MCAP0\r\n", b"SQLite format 3\0", b"#ROSBAG")
    keys: ClassVar[Keys] = {
        "topic": Key("a topic", "of joint states in a bag", "/joint_states", "the only such one"),
        "command_topic": Key("a topic", "of commands in a bag", "/arm/commands", "none"),
    }

    @classmethod
    def is_folder(cls, path: Path) -> bool:
        return (path / "metadata.yaml").is_file() or bool(_storages(path))

    def __init__(self, path: Path, name: str, given: Mapping[str, Any]) -> None:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        topic = _topic(name, given, "topic")
        command_topic = _topic(name, given, "command_topic")
        self.notes = []
        self._name = name
        self._reader: Any = None
        try:
            store = get_typestore(Stores.ROS2_HUMBLE)
            self._reader = AnyReader([_storage(path, name)], default_typestore=store)
            self._reader.open()
            self._open(topic, command_topic)
        except LoadError:
            self.close()
            raise
        except Exception as error:  # of a damaged file, rosbags and its storages raise many kinds
            self.close()
            raise LoadError(f"{name}: cannot be read as a bag: {error}") from error

    def _open(self, topic: str | None, command_topic: str | None) -> None:
        types = STATES if topic is None else None
        states = Topic(self._reader, self._name, self._state_topic(topic), types)
        self.rows = states.count
        self._states = states
        found: dict[str, None] = {}
        self.origin = 0.0
        for k, (stamp, sample) in enumerate(islice(states.samples(), _PEEKED)):
            self.origin = self.origin if k else stamp * 1e-9
            found |= dict.fromkeys(sample)
        if not found:
            raise LoadError(
                f"{self._name}: topic {states.name}: expected joint states or numbers, got none in"
                f" its {states.type}"
            )
        self.notes.append(f"joint states from topic {states.name}")
        self._held: dict[str, tuple[Any, FloatArray]] = {}
        if command_topic is not None:
            commands = Topic(self._reader, self._name, command_topic, COMMANDS)
            self._held, self._lines = commands.series(), commands.type == TRAJECTORY
            self.notes.append(f"commands from topic {command_topic}")
        elif states.type != JTC_STATE:
            self._tell_of_references()
        names = dict.fromkeys([*found, *self._held])
        self.columns = (
            Column(name="time", unit="s", converted=True),
            *(Column(name=each) for each in names),
        )

    def _state_topic(self, topic: str | None) -> str:
        if topic is not None:
            return topic
        topics = self._reader.topics
        for kind in STATES:
            found = sorted(each for each, info in topics.items() if info.msgtype == kind)
            if len(found) == 1:
                return str(found[0])
            if "/joint_states" in found:
                return "/joint_states"
            if found:
                raise LoadError(
                    f"{self._name}: several topics of type {kind}: {', '.join(found)}; say which"
                    " with 'topic:'"
                )
        there = ", ".join(sorted(topics)) or "none"
        raise LoadError(
            f"{self._name}: no topic of type {' or '.join(STATES)}; 'topic:' reads the fields of"
            f" any other; its topics: {there}"
        )

    def _tell_of_references(self) -> None:
        topics = self._reader.topics
        found = sorted(each for each, info in topics.items() if info.msgtype == JTC_STATE)
        if found:
            self.notes.append(
                f"topic {found[0]} has a controller's references: they are read with"
                f" 'command_topic: {found[0]}'"
            )

    def pieces(self, columns: Sequence[str]) -> Iterator[FloatArray]:
        stamps: list[int] = []
        rows: list[list[float]] = []
        try:
            first, asked = round(self.origin * 1e9), set(columns)
            for k, (stamp, sample) in enumerate(self._states.samples()):
                first = stamp if k == 0 else first
                if not sample.keys() & asked:
                    continue  # of other joints
                stamps.append(stamp)
                rows.append([sample.get(each, np.nan) for each in columns])
                if len(rows) == _PIECE:
                    yield self._piece(stamps, rows, columns, first)
                    stamps, rows = [], []
            if rows:
                yield self._piece(stamps, rows, columns, first)
        except Exception as error:  # as above
            raise LoadError(f"{self._name}: cannot be read as a bag: {error}") from error

    def _piece(
        self,
        stamps: Sequence[int],
        rows: Sequence[Sequence[float]],
        columns: Sequence[str],
        first: int,
    ) -> FloatArray:
        """Rows with their times and what was commanded then, in place."""
        piece = np.array(rows, dtype=np.float64)
        at = np.array(stamps, dtype=np.int64)
        for k, column in enumerate(columns):
            if column == "time":
                piece[:, k] = (at - first) * 1e-9
            elif column in self._held:
                piece[:, k] = _at(at, *self._held[column], lines=self._lines)
        return piece

    def close(self) -> None:
        if self._reader is not None and self._reader.stack is not None:
            self._reader.close()


def _at(at: Any, stamps: Any, values: FloatArray, *, lines: bool) -> FloatArray:
    """A command at these stamps [ns], NaN before the first."""
    if lines:
        between = np.interp(at - stamps[0], stamps - stamps[0], values)
        return np.where(at < stamps[0], np.nan, between)
    index = np.searchsorted(stamps, at, side="right") - 1
    return np.where(index < 0, np.nan, values[np.maximum(index, 0)])


def _storages(path: Path) -> list[Path]:
    return sorted(each for each in path.iterdir() if each.suffix in (".mcap", ".db3"))


def _topic(name: str, given: Mapping[str, Any], key: str) -> str | None:
    topic = given.get(key)
    if topic is not None and not isinstance(topic, str):
        raise LoadError(f"{name}: {key}: expected text, got {topic!r}")
    return topic


def _storage(path: Path, name: str) -> Path:
    """The bag, or the one file of a bag whose recorder did not live to describe it."""
    if not path.is_dir() or (path / "metadata.yaml").is_file():
        return path
    found = _storages(path)
    if len(found) > 1:
        files = ", ".join(each.name for each in found)
        raise LoadError(f"{name}: no metadata.yaml; expected it, or one of its files: {files}")
    return found[0]
