"""JSON lines, and LeRobot's data sets of versions 2 and 3, hold what a CSV holds."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import Recording
from pdoik.sim2real.study import load_study
from studies import JOINTS, columns, motion, speed, write_study

TIME = np.arange(800) / 100
TABLE = columns(TIME)


def loaded(folder: Path, file: str, keys: Any = None, **entry: Any) -> Recording:
    recordings = [{"file": file, **entry}]
    return load_study(write_study(folder, {}, recordings=recordings, **(keys or {}))).fit[0]


def check_arm(recording: Recording, *channels: str, start: float = 0.0) -> None:
    """That it is the arm's motion, in the study's order of joints."""
    assert recording.channels == channels
    assert recording.start == pytest.approx(start)
    assert recording.period == pytest.approx(0.01)
    assert np.allclose(recording.q, motion(recording.time), atol=1e-6)
    if recording.dq is not None:
        assert np.allclose(recording.dq, speed(recording.time), atol=1e-6)


def lines(kind: str) -> list[dict[str, Any]]:
    rows = []
    for k, t in enumerate(TIME.tolist()):
        q, dq, tau = (
            [float(TABLE[f"{channel}.{joint}"][k]) for joint in JOINTS]
            for channel in ("q", "dq", "tau")
        )
        if kind == "lists":
            rows.append({"t": t, "q": q, "dq": dq, "tau": tau, "ok": True, "mode": "run"})
        elif kind == "state":  # as ROS's JointState, the joints in another order each time
            order = [0, 1] if k % 2 else [1, 0]
            stamp = {"sec": 100 + int(t), "nanosec": round((t - int(t)) * 1e9)}
            rows.append(
                {
                    "header": {"stamp": stamp, "frame_id": ""},
                    "name": [JOINTS[j] for j in order],
                    "position": [q[j] for j in order],
                    "velocity": [dq[j] for j in order],
                    "effort": [tau[j] for j in order],
                }
            )
        else:
            rows.append(
                {
                    "timestamp": t,
                    "motors": [
                        {"name": joint, "angle": a, "speed": b, "torque": c, "temperature": 40}
                        for joint, a, b, c in zip(JOINTS, q, dq, tau, strict=True)
                    ],
                }
            )
    return rows


def write_lines(path: Path, rows: list[Any], end: str = "") -> None:
    path.write_text("".join(json.dumps(row) + "\n" for row in rows) + end)


@pytest.mark.parametrize("kind", ["lists", "state", "objects"])
def test_objects_are_rows(tmp_path: Path, kind: str) -> None:
    write_lines(tmp_path / "a.jsonl", lines(kind))
    start = 100.0 if kind == "state" else 0.0
    check_arm(loaded(tmp_path, "a.jsonl"), "q", "dq", "tau", start=start)


def test_packed_or_cut_off_lines_are_read(tmp_path: Path) -> None:
    text = "".join(json.dumps(row) + "\n" for row in lines("lists"))
    (tmp_path / "a.jsonl.gz").write_bytes(gzip.compress(text.encode()))
    check_arm(loaded(tmp_path, "a.jsonl.gz"), "q", "dq", "tau")
    write_lines(tmp_path / "a.jsonl", lines("lists"), '{"t": 8.0, "q": [0.1,')
    recording = loaded(tmp_path, "a.jsonl")
    check_arm(recording, "q", "dq", "tau")
    assert "the last line is cut off and was left out" in recording.notes


def test_what_is_missing_is_no_number(tmp_path: Path) -> None:
    rows = lines("lists")
    rows[100]["tau"] = [None, 1.0]
    del rows[101]["dq"]
    write_lines(tmp_path / "a.jsonl", rows)
    notes = "\n".join(loaded(tmp_path, "a.jsonl").notes)
    assert "1 missing values of 'tau.shoulder'" in notes
    assert "1 missing values of 'dq.elbow'" in notes


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda rows: [*rows[:400], [1, 2], *rows[400:]], "line 401: expected an object"),
        (
            lambda rows: [*rows[:400], rows[400] | {"q": [1.0]}, *rows[401:]],
            "line 401: 'q' has 1 numbers, expected 2",
        ),
        (
            lambda rows: [*rows[:400], rows[400] | {"t": "x"}, *rows[401:]],
            "line 401: 't' is 'x', expected a number",
        ),
        (lambda rows: [{"mode": "run"}] * 3, "no numbers in its first 3 lines"),
        (lambda rows: [{"q": row["q"]} for row in rows], r"expected a column 'time'.*q\[0\]"),
    ],
)
def test_what_is_wrong_with_lines_is_said(tmp_path: Path, change: Any, message: str) -> None:
    write_lines(tmp_path / "a.jsonl", change(lines("lists")))
    with pytest.raises(LoadError, match=message):
        loaded(tmp_path, "a.jsonl")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "no numbers in its first 0 lines"),
        (b"time,q\n0,1\n1,2\n", "line 1: expected one JSON object a line"),
        (b'{"t": 1}\n{"t": \n{"t": 2}\n', "line 2: expected one JSON object a line"),
        (b'{"t": "\xff"}\n', "no JSON text"),
    ],
)
def test_what_is_no_json_is_said(tmp_path: Path, text: bytes, message: str) -> None:
    (tmp_path / "a.json").write_bytes(text)
    with pytest.raises(LoadError, match=message):
        loaded(tmp_path, "a.json")


def write_lerobot(folder: Path, version: str = "v3.0", names: Any = "pos", **info: Any) -> None:
    """Three episodes: the first and the last stand still, the middle one is the arm's motion."""
    joints = JOINTS[::-1]
    labels = [f"{joint}.pos" for joint in joints] if names == "pos" else names
    feature = {"dtype": "float32", "shape": [2], "names": labels}
    single = {"shape": [1], "names": None}
    template = {
        "v3.0": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "v2.1": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
    }[version]
    content = {
        "codebase_version": version,
        "robot_type": "arm",
        "total_episodes": 3,
        "chunks_size": 1000,
        "fps": 100,
        "data_path": template,
        "features": {
            "action": feature,
            "observation.state": feature,
            "observation.images.top": {"dtype": "video", "shape": [480, 640, 3], "names": None},
            "timestamp": {"dtype": "float32", **single},
            "frame_index": {"dtype": "int64", **single},
            "episode_index": {"dtype": "int64", **single},
        },
    } | info
    (folder / "meta").mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(content))
    tables = []
    for episode in range(3):
        q = motion(TIME)[:, ::-1] if episode == 1 else np.zeros((800, 2))
        state = pa.array(list(q.astype(np.float32)), pa.list_(pa.float32()))
        action = pa.array(list((q + 0.01).astype(np.float32)), pa.list_(pa.float32(), 2))
        tables.append(
            pa.table(
                {
                    "action": action,
                    "observation.state": state,
                    "timestamp": TIME.astype(np.float32),
                    "frame_index": np.arange(800),
                    "episode_index": np.full(800, episode),
                }
            )
        )
    chunk = folder / "data/chunk-000"
    chunk.mkdir(parents=True)
    if version == "v3.0":
        parquet.write_table(
            pa.concat_tables(tables), chunk / "file-000.parquet", row_group_size=700
        )
        return
    for episode, table in enumerate(tables):
        parquet.write_table(table, chunk / f"episode_{episode:06d}.parquet")


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
@pytest.mark.parametrize("names", ["pos", list(JOINTS[::-1]), {"motors": list(JOINTS[::-1])}])
def test_an_episode_is_a_recording(tmp_path: Path, version: str, names: Any) -> None:
    write_lerobot(tmp_path / "set", version, names)
    recording = loaded(tmp_path, "set", episode=1)
    check_arm(recording, "q", "q_des")
    assert recording.q_des is not None
    assert np.allclose(recording.q_des, recording.q + 0.01, atol=1e-6)
    assert "episode 1 of 3" in recording.notes


def test_without_joints_and_robot_the_data_sets_own_are_taken(tmp_path: Path) -> None:
    write_lerobot(tmp_path / "set")
    entry = {"file": "set", "episode": 1}
    study = load_study(write_study(tmp_path, {}, None, joints=None, recordings=[entry]))
    assert study.joints == JOINTS[::-1]
    assert np.allclose(study.fit[0].q[:, ::-1], motion(study.fit[0].time), atol=1e-6)


def test_other_names_are_mapped_by_the_study(tmp_path: Path) -> None:
    write_lerobot(tmp_path / "set", names=["motor_1", "motor_2"])
    with pytest.raises(LoadError, match=r"expected a column 'q.shoulder'"):
        loaded(tmp_path, "set", episode=1)
    mapped = {
        "q": {"elbow": "observation.state.motor_1", "shoulder": "observation.state.motor_2"},
        "q_des": {"elbow": "action[0]", "shoulder": "action[1]"},
    }
    check_arm(loaded(tmp_path, "set", {"columns": mapped}, episode=1), "q", "q_des")


@pytest.mark.parametrize(
    ("entry", "info", "message"),
    [
        ({}, {}, "expected one of 0 to 2 .* none was said"),
        ({"episode": 3}, {}, "expected one of 0 to 2 .* got 3"),
        ({"episode": "one"}, {}, "got 'one'"),
        ({"episode": 1}, {"fps": 0}, "expected fps above 0"),
        ({"episode": 1}, {"features": None}, "meta/info.json: expected fps, features"),
        ({"episode": 4}, {"total_episodes": 5}, "no frame of episode 4 in data/"),
        ({"topic": "/q"}, {}, "topic: is of a ROS bag only, this file is a LeRobot data set"),
    ],
)
def test_what_is_wrong_with_a_data_set_is_said(
    tmp_path: Path, entry: dict[str, Any], info: dict[str, Any], message: str
) -> None:
    write_lerobot(tmp_path / "set", **info)
    with pytest.raises(LoadError, match=message):
        loaded(tmp_path, "set", **entry)


def test_what_is_wrong_with_its_files_is_said(tmp_path: Path) -> None:
    write_lerobot(tmp_path / "set", "v2.1")
    file = tmp_path / "set/data/chunk-000/episode_000001.parquet"
    whole = parquet.read_table(file)
    ragged = [row[: 1 + (k != 5)] for k, row in enumerate(whole["observation.state"].to_pylist())]
    broken = whole.set_column(1, "observation.state", [ragged])
    parquet.write_table(broken, file)
    with pytest.raises(LoadError, match="has 1599 numbers in 800 frames, expected 2 in each"):
        loaded(tmp_path, "set", episode=1)
    parquet.write_table(whole.drop_columns("action"), file)
    with pytest.raises(LoadError, match=r"episode_000001.parquet: no column 'action'"):
        loaded(tmp_path, "set", episode=1)
    file.write_bytes(file.read_bytes()[:500])
    with pytest.raises(LoadError, match=r"episode_000001.parquet: cannot be read"):
        loaded(tmp_path, "set", episode=1)
    file.unlink()
    with pytest.raises(LoadError, match=r"episode_000001.parquet: cannot be read"):
        loaded(tmp_path, "set", episode=1)
