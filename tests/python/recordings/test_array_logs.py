"""HDF5 files, written by h5py, and NPZ files, by NumPy, hold what the same CSV holds."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdoik.errors import LoadError
from pdoik.recordings import Recording
from pdoik.sim2real.study import load_study
from studies import JOINTS, columns, log, motion, write_study

h5py = pytest.importorskip("h5py")

TIME = np.arange(800) / 100
TABLE = columns(TIME)


def stacked(channel: str, joints: tuple[str, ...] = JOINTS) -> np.ndarray:
    """A channel of these joints, (T, n)."""
    return np.stack([TABLE[f"{channel}.{joint}"] for joint in joints], axis=1)


def of_csv(folder: Path, **entry: Any) -> Recording:
    (folder / "csv").mkdir()
    keys = {"recordings": [{"file": "a.csv", **entry}]}
    return load_study(write_study(folder / "csv", {"a.csv": log()}, **keys)).fit[0]


def loaded(folder: Path, file: str, *, keys: Any = None, **entry: Any) -> Recording:
    entry = {"file": file, **entry}
    return load_study(write_study(folder, {}, recordings=[entry], **(keys or {}))).fit[0]


def check_same(recording: Recording, expected: Recording, start: float | None = None) -> None:
    assert recording.channels == expected.channels
    assert np.array_equal(recording.time, expected.time)
    assert recording.start == pytest.approx(expected.start if start is None else start)
    for channel in expected.channels:
        assert np.allclose(getattr(recording, channel), getattr(expected, channel), atol=1e-12)


def plain_arrays() -> dict[str, np.ndarray]:
    """As students save them, the joints in another order than the study's."""
    swapped = JOINTS[::-1]
    return {
        "t": TIME,
        "joint_pos": stacked("q", swapped),
        "joint_vel": stacked("dq", swapped),
        "joint_effort": stacked("tau", swapped),
        "joint_names": np.array(swapped),
    }


def write_h5(path: Path, arrays: dict[str, np.ndarray], **attributes: Any) -> None:
    with h5py.File(path, "w") as file:
        for name, values in arrays.items():
            text = values.dtype.kind == "U"
            file.create_dataset(
                name,
                data=list(values) if text else values,
                dtype=h5py.string_dtype() if text else None,
            )
        file.attrs.update(attributes)


def write_npz(path: Path, arrays: dict[str, np.ndarray], **attributes: Any) -> None:
    np.savez_compressed(path, **arrays, **{k: np.array(v) for k, v in attributes.items()})


WRITERS: dict[str, Callable[..., None]] = {"a.h5": write_h5, "a.npz": write_npz}
BOTH = pytest.mark.parametrize("file", WRITERS)


@BOTH
def test_arrays_with_their_joints_names_are_the_csv(tmp_path: Path, file: str) -> None:
    WRITERS[file](tmp_path / file, plain_arrays())
    recording = loaded(tmp_path, file)
    check_same(recording, of_csv(tmp_path))
    notes = "\n".join(recording.notes)
    assert "joint_pos[0] read as q.elbow, joint_pos[1] read as q.shoulder" in notes


@BOTH
def test_a_part_of_arrays_is_that_of_the_csv(tmp_path: Path, file: str) -> None:
    WRITERS[file](tmp_path / file, plain_arrays())
    part = {"every": 2, "window": [1, 6]}
    check_same(loaded(tmp_path, file, **part), of_csv(tmp_path, **part))


@BOTH
def test_a_long_log_is_read_in_pieces(tmp_path: Path, file: str) -> None:
    time = np.arange(40_000) / 500
    table = columns(time)
    q = np.stack([table[f"q.{joint}"] for joint in JOINTS], axis=1)
    WRITERS[file](tmp_path / file, {"t": time, "q": q})
    recording = loaded(tmp_path, file)
    assert len(recording.time) > 16384  # rows of a piece
    assert np.allclose(recording.q, q[: len(recording.time)])
    with pytest.raises(LoadError, match="about 40,000 rows, expected at most 1,000"):
        loaded(tmp_path, file, keys={"max_rows": 1000})
    assert len(loaded(tmp_path, file, keys={"max_rows": 1500}, window=[10, 12.5]).time) > 800


@BOTH
@pytest.mark.parametrize("said", [{"dt": 0.01}, {"fps": 100}, {"control_freq": 100.0}])
def test_a_rate_in_the_file_stands_for_times(
    tmp_path: Path, file: str, said: dict[str, float]
) -> None:
    arrays = plain_arrays()
    del arrays["t"]
    WRITERS[file](tmp_path / file, arrays, **said)
    recording = loaded(tmp_path, file)
    check_same(recording, of_csv(tmp_path))
    assert "no column of times: 100 rows a second" in recording.notes


@BOTH
def test_records_are_columns(tmp_path: Path, file: str) -> None:
    names = ["time", *(f"{joint}_{word}" for joint in JOINTS for word in ("pos", "vel", "torque"))]
    records = np.zeros(800, dtype=[(name, np.float64) for name in names])
    short = {"pos": "q", "vel": "dq", "torque": "tau"}
    records["time"] = TIME
    for joint in JOINTS:
        for word, channel in short.items():
            records[f"{joint}_{word}"] = TABLE[f"{channel}.{joint}"]
    WRITERS[file](tmp_path / file, {"log": records})
    check_same(loaded(tmp_path, file), of_csv(tmp_path))


@BOTH
def test_numbers_may_be_single_precision_or_stored_by_columns(tmp_path: Path, file: str) -> None:
    arrays = plain_arrays()
    arrays["joint_pos"] = np.asfortranarray(arrays["joint_pos"].astype(">f4"))
    WRITERS[file](tmp_path / file, arrays)
    recording = loaded(tmp_path, file)
    assert np.allclose(recording.q, motion(recording.time), atol=1e-6)


def without(*names: str) -> Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]]:
    return lambda arrays: {k: v for k, v in arrays.items() if k not in names}


FAULTS: dict[str, tuple[Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]], str]] = {
    "no time": (without("t"), r"expected a column 'time'.*it has joint_.*'rate:' \[Hz\]"),
    "ragged": (
        lambda a: a | {"joint_vel": a["joint_vel"][:-1]},
        "'joint_vel' has 799 rows, '.*' has 800; expected as many",
    ),
    "other joints": (
        lambda a: a | {"joint_names": np.array(["hip", "knee"])},
        "expected a column 'q.shoulder'",
    ),
    "too many": (
        lambda a: without("joint_names")(a) | {"joint_pos": np.zeros((800, 3))},
        "expected a column 'q.shoulder'",
    ),
    "text": (
        lambda a: {"t": np.array(["a"] * 800), "joint_names": a["joint_names"]},
        "no (arrays|data sets) of numbers",
    ),
    "backwards": (lambda a: a | {"t": a["t"][::-1].copy()}, "time runs backwards"),
}


@BOTH
@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_wrong_with_arrays_is_said(tmp_path: Path, file: str, fault: str) -> None:
    change, message = FAULTS[fault]
    WRITERS[file](tmp_path / file, change(plain_arrays()))
    with pytest.raises(LoadError, match=message):
        loaded(tmp_path, file)


@BOTH
@pytest.mark.parametrize("kept", [0, 100, 0.5, 0.95])
def test_a_cut_off_file_is_said(tmp_path: Path, file: str, kept: float) -> None:
    WRITERS[file](tmp_path / file, plain_arrays())
    whole = (tmp_path / file).read_bytes()
    (tmp_path / file).write_bytes(whole[: int(kept if kept > 1 else kept * len(whole))])
    with pytest.raises(LoadError, match=r"a\.(npz|h5): (no (NPZ|HDF5) file|cannot be read on)"):
        loaded(tmp_path, file)


def test_a_bad_rate_is_said(tmp_path: Path) -> None:
    arrays = without("t")(plain_arrays())
    write_h5(tmp_path / "a.h5", arrays, dt=0.0)
    with pytest.raises(LoadError, match="dt: expected a number above 0"):
        loaded(tmp_path, "a.h5")


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    arrays = plain_arrays()
    np.savez(tmp_path / "a.npz", info=np.array([{"a": 1}], dtype=object), **arrays)
    notes = loaded(tmp_path, "a.npz").notes
    assert "arrays of Python objects are not read: info" in notes
    np.savez(tmp_path / "a.npz", q=np.array([[0.1], [0.2, 0.3]], dtype=object))
    with pytest.raises(LoadError, match="q hold Python objects, which are not read"):
        loaded(tmp_path, "a.npz")


def test_what_a_file_is_shows_in_how_it_begins(tmp_path: Path) -> None:
    write_h5(tmp_path / "a.log", plain_arrays())
    check_same(loaded(tmp_path, "a.log"), of_csv(tmp_path))


def test_units_of_data_sets_are_read(tmp_path: Path) -> None:
    arrays = plain_arrays()
    arrays["joint_pos"] = np.degrees(arrays["joint_pos"])
    arrays["t"] = 1000 * arrays["t"]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values in without("joint_names")(arrays).items():
            file[name] = values
        file["joint_pos"].attrs["unit"] = "degrees"
        file["t"].attrs["unit"] = "ms"
        file.attrs["joint_names"] = list(JOINTS[::-1])
    check_same(loaded(tmp_path, "a.h5"), of_csv(tmp_path))


def write_demos(path: Path, *, dt: bool = True) -> None:
    """As Isaac Lab's recorder does: demo_1 is the arm's, demo_3 another."""
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        arguments: dict[str, Any] = {"env_name": "Isaac-Arm-v0", "type": 2}
        arguments |= {"sim_args": {"dt": 0.005, "decimation": 2}} if dt else {}
        data.attrs["env_args"] = json.dumps(arguments)
        for k in (1, 3):
            demo = data.create_group(f"demo_{k}")
            demo.attrs["num_samples"] = 800
            q, dq = (k + 1) / 2 * stacked("q").astype("f4"), stacked("dq").astype("f4")
            demo["actions"] = np.zeros((800, 7), "f4")
            demo["obs/joint_pos"] = q - q[0]
            demo["obs/joint_vel"] = dq
            demo["obs/eef_pos"] = np.zeros((800, 3), "f4")
            demo["obs/camera"] = np.zeros((800, 4, 4, 3), "u1")
            demo["initial_state/articulation/robot/joint_position"] = q[:1]
            demo["states/articulation/robot/joint_position"] = q
            demo["states/articulation/robot/joint_velocity"] = dq
            demo["states/articulation/robot/root_pose"] = np.zeros((800, 7), "f4")


def test_a_demonstration_of_isaac_lab(tmp_path: Path) -> None:
    write_demos(tmp_path / "a.hdf5")
    for demo in (1, "demo_1"):
        recording = loaded(tmp_path, "a.hdf5", demo=demo)
        assert recording.channels == ("q", "dq")
        assert recording.period == pytest.approx(0.01)
        assert np.allclose(recording.q, motion(recording.time), atol=1e-6)
    third = loaded(tmp_path, "a.hdf5", group="data/demo_3")
    assert np.allclose(third.q, 2 * motion(third.time), atol=1e-5)
    policy = {"columns": {"q": "obs/joint_pos[{index}]"}}
    recording = loaded(tmp_path, "a.hdf5", demo=1, keys=policy)
    assert np.allclose(recording.q, motion(recording.time) - motion(TIME[:1]), atol=1e-6)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ({}, "2 demonstrations: demo_1, demo_3; say which with 'demo:'"),
        ({"demo": 2}, "no demonstration '2'; nearest: 'demo_.'"),
        ({"group": "data/demo1"}, "no group 'data/demo1'; nearest: 'data/demo_1'"),
        ({"episode": 1}, "episode: is of a LeRobot data set only, this file is HDF5"),
    ],
)
def test_what_is_wrong_with_a_demonstration_is_said(
    tmp_path: Path, entry: dict[str, Any], message: str
) -> None:
    write_demos(tmp_path / "a.hdf5")
    with pytest.raises(LoadError, match=message):
        loaded(tmp_path, "a.hdf5", **entry)


def test_without_a_rate_a_demonstration_asks_for_one(tmp_path: Path) -> None:
    write_demos(tmp_path / "a.hdf5", dt=False)
    with pytest.raises(LoadError, match=r"'rate:' \[Hz\]"):
        loaded(tmp_path, "a.hdf5", demo=1)
    assert loaded(tmp_path, "a.hdf5", demo=1, rate=100).period == pytest.approx(0.01)


def test_a_demonstration_of_robomimic(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "low_dim.hdf5", "w") as file:
        demo = file.create_group("data/demo_0")
        file["data"].attrs["env_args"] = json.dumps({"env_kwargs": {"control_freq": 100}})
        q = stacked("q")
        demo["actions"] = np.zeros((800, 7))
        demo["states"] = np.zeros((800, 71))
        demo["obs/robot0_joint_pos"] = q
        demo["obs/robot0_joint_pos_cos"] = np.cos(q)
        demo["obs/robot0_joint_pos_sin"] = np.sin(q)
        demo["obs/robot0_joint_vel"] = stacked("dq")
        demo["obs/robot0_gripper_qpos"] = np.zeros((800, 2))
        demo["obs/robot0_eef_pos"] = np.zeros((800, 3))
        demo["next_obs/robot0_joint_pos"] = q
    recording = loaded(tmp_path, "low_dim.hdf5")
    assert recording.channels == ("q", "dq")
    assert recording.period == pytest.approx(0.01)
    assert np.allclose(recording.q, motion(recording.time))
