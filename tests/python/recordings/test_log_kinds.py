"""A kind of log is one class that registers itself; everything else asks the registry."""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import KINDS, Column, Key, Keys, Log, read_log, register
from pdoik.sim2real.study import load_study
from studies import JOINTS, log, motion, write_study

ROW = struct.Struct("<3d")


@pytest.fixture
def ticker() -> Iterator[type[Log]]:
    """A stranger's kind: rows of time and two angles in deg, a letter in front."""

    @register
    class Ticker(Log):
        kind = "a ticker"
        suffixes = (".tick",)
        magic = (b"TICK",)
        keys: ClassVar[Keys] = {"turned": Key("true or false", "by half a turn", "true", "false")}

        def __init__(self, path: Path, name: str, told: Mapping[str, Any]) -> None:
            self.notes = ["ticks"]
            self._rows = list(ROW.iter_unpack(path.read_bytes()[4:]))
            self._sign = -1.0 if told.get("turned") else 1.0
            self.rows = len(self._rows)
            self.columns = (
                Column(name="clock", unit="s", channel="time"),
                Column(name="shoulder angle", unit="deg"),
                Column(name="elbow angle", unit="deg"),
            )

        def pieces(self, columns: Sequence[str]) -> Iterator[np.ndarray]:
            at = [[each.name for each in self.columns].index(name) for name in columns]
            table = np.array(self._rows)
            table[:, 1:] *= self._sign
            for k in range(0, len(table), 100):
                yield table[k : k + 100, at]

    yield Ticker
    del KINDS["a ticker"]


def write_ticks(path: Path, sign: float = 1.0) -> None:
    time = np.arange(800) / 100
    degrees = sign * np.degrees(motion(time))
    rows = (ROW.pack(t, *q) for t, q in zip(time.tolist(), degrees.tolist(), strict=True))
    path.write_bytes(b"TICK" + b"".join(rows))


@pytest.mark.parametrize("name", ["a.tick", "a.bin"])
def test_a_kind_of_ones_own_is_read_like_the_others(
    tmp_path: Path, ticker: type[Log], name: str
) -> None:
    write_ticks(tmp_path / name, -1.0)
    entry = {"file": name, "turned": True}
    recording = load_study(write_study(tmp_path, {}, recordings=[entry])).fit[0]
    assert np.allclose(recording.q, motion(recording.time))
    assert "ticks" in recording.notes
    assert "shoulder angle read as q.shoulder in deg" in "\n".join(recording.notes)


def test_keys_of_an_entry_belong_to_kinds(tmp_path: Path, ticker: type[Log]) -> None:
    write_ticks(tmp_path / "a.tick")
    entry = {"file": "a.tick", "episode": 1}
    with pytest.raises(LoadError, match="episode: is of a LeRobot data set only, this file is a t"):
        load_study(write_study(tmp_path, {}, recordings=[entry]))


def test_two_kinds_of_one_name_are_refused(ticker: type[Log]) -> None:
    class Other(ticker):  # type: ignore[misc, valid-type]
        pass

    with pytest.raises(ValueError, match="there is another kind of log 'a ticker': Ticker"):
        register(Other)


def write_state_bag(path: Path, plugin: Any) -> None:
    """One message a row, as rosbags writes it; the storage's file alone is kept."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    kind = "sensor_msgs/msg/JointState"
    stamp = types.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    header = types.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    none = np.empty(0)
    with Writer(path.with_suffix(".bag"), version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/joint_states", kind, typestore=types)
        for k, q in enumerate(motion(np.arange(300) / 100)):
            message = types.types[kind](header, list(JOINTS), q.copy(), none, none)
            writer.write(connection, (k + 1) * 10**7, types.serialize_cdr(message, kind))
    next(path.with_suffix(".bag").glob(f"*{path.suffix}")).rename(path)


def write_any(path: Path) -> None:
    """A log of the kind that the suffix says, by the library that writes it."""
    table = log(3.0)
    if path.suffix == ".csv":
        table.to_csv(path, index=False)
    elif path.suffix == ".parquet":
        table.to_parquet(path)
    elif path.suffix == ".jsonl":
        table.to_json(path, orient="records", lines=True)
    elif path.suffix == ".npz":
        np.savez(path, **{name: table[name].to_numpy() for name in table})
    elif path.suffix == ".h5":
        import h5py

        with h5py.File(path, "w") as file:
            for name in table:
                file[name] = table[name].to_numpy()
    else:
        from rosbags.rosbag2 import StoragePlugin

        plugins = {".mcap": StoragePlugin.MCAP, ".db3": StoragePlugin.SQLITE3}
        write_state_bag(path, plugins[path.suffix])


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".jsonl", ".npz", ".h5", ".mcap", ".db3"])
def test_a_damaged_log_is_read_or_refused_in_a_sentence(tmp_path: Path, suffix: str) -> None:
    write_any(tmp_path / f"whole{suffix}")
    whole = (tmp_path / f"whole{suffix}").read_bytes()
    damaged = tmp_path / f"damaged{suffix}"
    random = np.random.default_rng(11)

    def read(content: bytes) -> str:
        damaged.write_bytes(content)
        try:
            read_log(damaged, joints=JOINTS)
        except LoadError as error:
            return str(error)
        return ""

    assert not read(whole)
    refused = []
    for _ in range(40):
        content = bytearray(whole)
        for at in random.integers(0, random.choice([400, 4000, len(whole)]), 5):
            content[min(at, len(whole) - 1)] = random.integers(256)
        cut = len(whole) if random.random() < 0.7 else random.integers(len(whole))
        refused.append(read(bytes(content[:cut])))
    assert any(refused)
    assert all(damaged.name in message for message in refused if message)


def test_a_missing_library_is_asked_for_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(LoadError, match=r"a.h5: HDF5 needs h5py: pip install h5py"):
        load_study(write_study(tmp_path, {}, recordings=["a.h5"]))
