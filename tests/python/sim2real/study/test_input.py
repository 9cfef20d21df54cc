"""Studies are read as they are: every kind of file, uneven times, gaps, units and splits."""

from __future__ import annotations

import gzip
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from pdoik.recordings import on_grid, uniform_grid
from pdoik.sim2real.study import load_study
from studies import JOINTS, MJCF, URDF, columns, log, motion, speed, write_study

BESIDE = Path(__file__).resolve().parents[5] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"


def test_a_study_says_all_it_may(tmp_path: Path) -> None:
    table = log()
    table["q_des.shoulder"] = table["q.shoulder"]
    for name, value in zip(("x", "y", "z", "qw", "qx", "qy", "qz"), range(7), strict=True):
        table[f"tip.{name}"] = float(value == 3) if value > 2 else 0.1 * value
    study = load_study(
        write_study(
            tmp_path,
            {"a.csv": table, "b.csv": log(5.0, start=100.0)},
            tip="tool",
            controller={
                "type": "pd",
                "kp": [100, 50],
                "kd": ["1e1", 5],  # YAML takes 1e1 for text
                "gravity_compensation": True,
                "torque_limit": {"elbow": 30, "shoulder": 60},
                "period": 0.001,
            },
            simulation=["a.csv"],
            trust={"rigid_body": 0.1},
            rotor_inertia=[0.1, 0.2],
        )
    )
    assert study.folder == tmp_path
    assert study.robot == tmp_path / "arm.urdf"
    assert study.tip == "tool"
    assert study.joints == JOINTS
    assert study.split == "by the study"
    assert [each.name for each in study.fit] == ["a.csv"]
    assert [each.name for each in study.validate] == ["b.csv"]
    assert [each.name for each in study.simulation] == ["a.csv"]
    assert study.trust.rigid_body == 0.1
    assert study.rotor_inertia is not None
    assert study.rotor_inertia.tolist() == [0.1, 0.2]
    controller = study.controller
    assert controller is not None
    assert controller.kp.tolist() == [100, 50]
    assert controller.kd.tolist() == [10, 5]
    assert controller.torque_limit is not None
    assert controller.torque_limit.tolist() == [60, 30]
    assert controller.gravity_compensation
    assert controller.period == 0.001
    first, second = study.recordings
    assert first.channels == ("q", "dq", "tau", "q_des", "tip")
    assert first.tip is not None
    assert np.allclose(first.tip, [0, 0.1, 0.2, 1, 0, 0, 0])
    assert first.q_des is not None
    assert np.isnan(first.q_des[:, 1]).all()  # logged for the shoulder only
    assert second.start == 100.0
    assert second.time[0] == 0
    even = table[["q.shoulder", "q.elbow"]].to_numpy()  # even times are left as they are
    assert np.array_equal(first.q, even)
    assert first.period == pytest.approx(0.01)
    assert first.valid.all()


def test_a_study_made_in_python_is_checked_and_kept(tmp_path: Path) -> None:
    study = load_study(write_study(tmp_path))
    assert load_study(study) is study
    with pytest.raises(ValueError, match=r"rotor_inertia is \(3,\), expected \(2,\)"):
        load_study(replace(study, rotor_inertia=np.zeros(3)))
    with pytest.raises(ValueError, match="none has the role fit"):
        load_study(replace(study, recordings=study.validate))


@pytest.mark.parametrize("kind", ["parquet", "semicolon", "comma", "tab", "gz", "bom", "truncated"])
def test_the_same_rows_in_other_formats(tmp_path: Path, kind: str) -> None:
    table = log()
    name = {"parquet": "a.parquet", "gz": "a.csv.gz", "tab": "a.tsv"}.get(kind, "a.csv")
    path = tmp_path / name
    text = table.to_csv(index=False)
    if kind == "parquet":
        table.to_parquet(path)
    elif kind == "semicolon":
        path.write_text(text.replace(",", "; "))
    elif kind == "comma":
        path.write_text(
            text.replace(",", ";").replace(".", ",").replace("q,", "q.", 4).replace("tau,", "tau.")
        )
    elif kind == "tab":
        path.write_text(text.replace(",", "\t"))
    elif kind == "gz":
        path.write_bytes(gzip.compress(text.encode()))
    elif kind == "bom":
        path.write_text("\ufeff" + text.replace("\n", "\r\n"), newline="")
    else:
        path.write_text(text + "8.0,0.1,0.")  # the logger was killed
    study = load_study(write_study(tmp_path, {}, recordings=[name]))
    fit = study.fit[0]
    assert np.allclose(fit.q, motion(fit.time), atol=1e-12)
    assert any("incomplete row" in note for note in study.notes) == (kind == "truncated")


def test_robots_in_mjcf_bring_their_armature(tmp_path: Path) -> None:
    study = load_study(write_study(tmp_path, None, MJCF.format(mass=1), tip="tool"))
    assert study.rotor_inertia is not None
    assert study.rotor_inertia.tolist() == [0.05, 0.02]
    given_too = load_study(
        write_study(tmp_path, None, MJCF.format(mass=1), rotor_inertia=[0.3, 0.3])
    )
    assert given_too.rotor_inertia is not None
    assert given_too.rotor_inertia.tolist() == [0.3, 0.3]


def test_joints_come_from_the_robot_or_the_columns(tmp_path: Path) -> None:
    other = log()
    other["q.gripper"] = 0.3
    study = load_study(write_study(tmp_path, {"a.csv": other, "b.csv": log()}, joints=None))
    assert study.joints == JOINTS
    assert any("gripper left out" in note for note in study.notes)
    turned = other[other.columns[::-1]]  # elbow first; the robot's order counts
    assert load_study(write_study(tmp_path, {"a.csv": turned}, joints=None)).joints == JOINTS
    free = load_study(write_study(tmp_path, {"a.csv": turned}, None, joints=None))
    assert set(free.joints) == {*JOINTS, "gripper"}
    assert any("no robot" in note for note in free.notes)
    assert any("joint gripper does not move" in note for note in free.notes)


@given(seed=st.integers(0, 10_000), jitter=st.floats(0.01, 0.3), start=st.floats(-1e3, 2e9))
def test_uneven_times_give_the_motion_at_even_times(seed: int, jitter: float, start: float) -> None:
    rng = np.random.default_rng(seed)
    raw = np.sort(0.01 * (np.arange(500) + jitter * rng.uniform(-1, 1, 500)))
    raw -= raw[0]
    grid = uniform_grid(raw)
    assert np.allclose(np.diff(grid.time), grid.period)
    assert grid.time[-1] <= raw[-1] + 1e-9
    assert raw[-1] - grid.time[-1] < grid.period
    q, backed = on_grid(grid, "q", motion(raw)[:, 0])
    assert np.abs(q - motion(grid.time)[:, 0]).max() < 2e-6
    assert backed.all()
    tau, _ = on_grid(grid, "tau", motion(raw)[:, 0])
    assert np.abs(tau - motion(grid.time)[:, 0]).max() < 4e-4
    steps = np.floor(raw / 0.5)  # commands keep their values: no step is smoothed
    held, _ = on_grid(grid, "q_des", steps)
    assert set(held) <= set(steps)
    index = np.searchsorted(raw, grid.time + 1e-5 * grid.period, side="right") - 1
    assert (held == steps[index]).mean() > 0.99


def test_few_digits_in_the_times_are_no_unevenness(tmp_path: Path) -> None:
    table = log()
    table["time"] = [float(f"{each:.7g}") for each in table["time"] * 0.9999991]
    recording = load_study(write_study(tmp_path, {"a.csv": table}, None)).fit[0]
    assert np.array_equal(
        recording.q, table[["q.shoulder", "q.elbow"]].to_numpy()[: len(recording.q)]
    )


def test_gaps_in_time_are_bridged_and_marked(tmp_path: Path) -> None:
    table = log()
    cut = table.drop(index=range(300, 380)).drop(index=500)
    study = load_study(write_study(tmp_path, {"a.csv": cut, "b.csv": log()}))
    recording = study.fit[0]
    assert len(recording.time) == len(table)
    assert not recording.valid[301:379].any()
    assert recording.valid[:300].all()
    assert recording.valid[380:].all()  # one lost row is bridged
    assert np.abs(recording.q - motion(recording.time))[recording.valid].max() < 1e-4
    assert any("1 gaps in time, the longest 0.81 s" in note for note in recording.notes)


def test_missing_values_are_bridged_if_few_and_marked_if_many(tmp_path: Path) -> None:
    table = log()
    table.loc[100:102, "q.elbow"] = np.nan
    table.loc[300:360, "tau.elbow"] = np.nan
    table.loc[770:, "dq.elbow"] = np.nan
    table.loc[200, "tau.shoulder"] = np.inf
    recording = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()})).fit[0]
    assert recording.valid[:299].all()
    assert not recording.valid[300:361].any()
    assert recording.valid[361:770].all()
    assert not recording.valid[780:].any()
    for channel in (recording.q, recording.dq, recording.tau):
        assert channel is not None
        assert np.isfinite(channel).all()
    assert np.abs(recording.q - motion(recording.time)).max() < 1e-5
    assert any("3 missing values of 'q.elbow' bridged" in note for note in recording.notes)


def test_a_channel_logged_more_rarely_has_no_gaps(tmp_path: Path) -> None:
    table = log()
    table.loc[table.index % 10 != 0, "tau.elbow"] = np.nan
    recording = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()})).fit[0]
    assert recording.valid[:790].all()


def test_repeated_stamps_are_left_out(tmp_path: Path) -> None:
    table = log()
    table = pd.concat([table, table.iloc[[10, 400]]]).sort_values("time", kind="stable")
    recording = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()})).fit[0]
    assert np.allclose(recording.q, motion(recording.time))
    assert any("2 rows with the time stamp of the row before" in note for note in recording.notes)


def test_columns_that_never_change_are_no_measurement(tmp_path: Path) -> None:
    table = log()
    table["tau.shoulder"] = 0.0
    table["dq.shoulder"] = table["dq.elbow"] = 0.0
    table["tau_cmd.elbow"] = 0.0  # a command may well be constant
    recording = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()})).fit[0]
    assert recording.dq is None
    assert recording.tau is not None
    assert np.isnan(recording.tau[:, 0]).all()
    assert np.isfinite(recording.tau[:, 1]).all()
    assert recording.tau_cmd is not None
    assert any("'tau.shoulder' is 0 throughout" in note for note in recording.notes)


def test_quaternions_keep_their_sign_and_norm(tmp_path: Path) -> None:
    table = log()
    angle = np.linspace(0, 4 * np.pi, len(table))
    sign = np.where(np.arange(len(table)) % 7 < 3, -1.0, 1.0)
    table["tip.qw"], table["tip.qz"] = (
        1.01 * sign * np.cos(angle / 2),
        1.01 * sign * np.sin(angle / 2),
    )
    for name in ("x", "y", "z", "qx", "qy"):
        table[f"tip.{name}"] = 0.0
    table = table.drop(index=[77, 78])
    tip = load_study(write_study(tmp_path, {"a.csv": table, "b.csv": log()})).fit[0].tip
    assert tip is not None
    assert np.allclose(np.linalg.norm(tip[:, 3:], axis=1), 1)
    assert np.abs(np.diff(tip[:, 3:], axis=0)).max() < 0.02


def test_three_recordings_hold_out_the_last_third(tmp_path: Path) -> None:
    logs = {f"{name}.csv": log(4.0) for name in "abcdefg"}
    study = load_study(write_study(tmp_path, logs, recordings=list(logs)))
    assert [each.name for each in study.validate] == ["f.csv", "g.csv"]
    assert study.split.startswith("by recording")
    assert any("held-out data were parted by recording" in note for note in study.notes)


def test_fewer_hold_out_the_last_block_of_each(tmp_path: Path) -> None:
    logs = {"a.csv": log(10.0), "b.csv": log(20.0, start=50.0)}
    study = load_study(write_study(tmp_path, logs, recordings=list(logs)))
    assert study.split.startswith("by blocks")
    assert [each.name for each in study.fit] == ["a.csv", "b.csv"]
    late = study.validate[1]
    assert late.name == "b.csv (last 30 %)"
    assert late.start == pytest.approx(64.0)
    assert late.time[0] == 0
    assert np.allclose(late.q, motion(late.time + 14.0))
    early = study.fit[1]
    assert early.start + early.time[-1] < late.start - 0.2  # neighbours are not told apart
    assert len(late.valid) == len(late.time) == 600


UNITS: dict[str, dict[str, Any]] = {
    "time": {"column": "time", "factor": 1e3, "unit": "ms"},
    "q": {"column": "q.", "factor": 180 / np.pi, "unit": "deg"},
    "dq": {"column": "dq.", "factor": 30 / np.pi, "unit": "rpm"},
    "tau": {"column": "tau.", "factor": 1e3, "unit": "mN m"},
}


@pytest.mark.parametrize("channel", UNITS)
def test_units_the_study_names_are_converted(tmp_path: Path, channel: str) -> None:
    case, table = UNITS[channel], log()
    wrong = [name for name in table if name.startswith(case["column"])]
    table[wrong] *= case["factor"]
    study = load_study(write_study(tmp_path, {"a.csv": table}, units={channel: case["unit"]}))
    recording = study.fit[0]
    assert recording.period == pytest.approx(0.01)
    assert recording.dq is not None
    assert recording.tau is not None
    assert np.allclose(recording.q, motion(recording.time))
    assert np.allclose(recording.dq, speed(recording.time))
    expected = columns(recording.time)
    assert np.allclose(recording.tau[:, 1], expected["tau.elbow"])


def test_a_piece_of_a_long_file(tmp_path: Path) -> None:
    table = log(20.0, start=5.0)
    entry = {"file": "a.csv", "window": [4, 12], "every": 2}
    study = load_study(write_study(tmp_path, {"a.csv": table}, recordings=[entry], max_rows=500))
    late = study.validate[0]
    assert late.period == pytest.approx(0.02)
    assert study.fit[0].start == pytest.approx(9.0)
    assert late.start + late.time[-1] == pytest.approx(17.0)
    assert np.allclose(late.q, motion(late.start - 5.0 + late.time))
    assert any("only 4 s to 12 s were read" in note for note in study.notes)


@pytest.mark.parametrize(
    ("folder", "robot_joints"),
    [("ur10_unisa", 6), ("panda_unisa", 7), ("so101_sage", 6), ("dfki_double_pendulum", 2)],
)
def test_real_recordings(tmp_path: Path, folder: str, robot_joints: int) -> None:
    if not (RECORDINGS / folder).is_dir():
        pytest.skip(f"needs recordings/{folder} of the shared material (PDOIK_SHARED or ../shared)")
    files = sorted((RECORDINGS / folder).glob("*.csv"))
    path = tmp_path / "study.yaml"
    path.write_text(yaml.safe_dump({"recordings": [str(file) for file in files]}))
    study = load_study(path)
    assert len(study.joints) == robot_joints
    assert study.fit
    assert study.validate
    for recording in study.recordings:
        assert recording.valid.mean() > 0.99
        assert recording.jitter < 0.05 * recording.raw_period
        raw = pd.read_csv(next(file for file in files if recording.name.startswith(file.name)))
        for k, joint in enumerate(study.joints):
            linear = np.interp(recording.time + recording.start, raw["time"], raw[f"q.{joint}"])
            assert np.abs(recording.q[:, k] - linear).max() < 0.02


def test_the_robot_may_be_shipped_elsewhere(tmp_path: Path) -> None:
    away = tmp_path / "models"
    away.mkdir()
    (away / "arm.urdf").write_text(URDF.format(mass=1))
    study = load_study(write_study(tmp_path, None, None, robot="models/arm.urdf"))
    assert study.robot == away / "arm.urdf"


def resampled(channel: str, values: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    grid = uniform_grid(times)
    return grid.time, on_grid(grid, channel, values)[0]


def test_commands_at_rest_for_most_of_the_time_are_no_stairs() -> None:
    """Their repeated values say nothing of how they go between two samples while they move."""
    rng = np.random.default_rng(1)
    times = 0.005 * np.arange(4000) + np.concatenate([[0.0], rng.uniform(-1e-3, 1e-3, 3999)])

    def command(t: np.ndarray) -> np.ndarray:
        phase = t % 10.0  # moves for three seconds of ten
        return np.where(phase < 3.0, np.sin(np.pi * phase / 3.0) ** 2, 0.0)

    at, found = resampled("dq_des", np.round(command(times), 6), times)
    inside = (at > 0.1) & (at < 19.8)
    assert found[inside] == pytest.approx(command(at)[inside], abs=2e-4)


def test_commands_of_a_slow_sender_stay_stairs() -> None:
    times = 0.004 * np.arange(2500) + np.concatenate([[0.0], np.full(2499, 3e-4)])
    stairs = np.floor(times / 0.05)
    at, found = resampled("q_des", stairs, times)
    assert set(np.unique(found)) <= set(np.unique(stairs))
    assert np.mean(found == np.floor(at / 0.05)) > 0.9
