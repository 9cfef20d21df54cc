"""A kind of log is one class that registers itself; everything else asks the registry."""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdoik.errors import LoadError
from pdoik.sim2real.study.logs import KINDS, Column, Log, register
from pdoik.sim2real.study.read_study import load_study
from studies import motion, write_study

ROW = struct.Struct("<3d")


@pytest.fixture
def ticker() -> Iterator[type[Log]]:
    """A stranger's kind: rows of time and two angles in deg, a letter in front."""

    @register
    class Ticker(Log):
        kind = "a ticker"
        suffixes = (".tick",)
        magic = (b"TICK",)
        keys = ("turned",)

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


def test_a_missing_library_is_asked_for_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(LoadError, match=r"a.h5: HDF5 needs h5py: pip install h5py"):
        load_study(write_study(tmp_path, {}, recordings=["a.h5"]))
