"""Whatever is wrong with a study, one sentence says where, what was expected and what came."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pdoik.errors import LoadError
from pdoik.recordings import KINDS
from pdoik.sim2real.study import load_study
from studies import JOINTS, MJCF, URDF, columns, log, write_study

DEGREES = 180 / np.pi


def scaled(prefix: str, factor: float) -> Callable[[pd.DataFrame], pd.DataFrame]:
    """Multiplies the columns that begin so."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        names = [name for name in table if name.startswith(prefix)]
        return table.assign(**{name: table[name] * factor for name in names})

    return change


def renamed(old: str, new: str) -> Callable[[pd.DataFrame], pd.DataFrame]:
    return lambda table: table.rename(columns={old: new})


def with_time(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[pd.DataFrame], pd.DataFrame]:
    return lambda table: table.assign(time=change(table["time"].to_numpy().copy()))


def swapped(time: np.ndarray) -> np.ndarray:
    time[400:] -= 1.0
    return time


LOGS: dict[str, tuple[Callable[[pd.DataFrame], pd.DataFrame], str]] = {
    "no time": (renamed("time", "tiem"), "bad.csv: expected a column 'time'.*nearest: 'tiem'"),
    "no position": (
        renamed("q.elbow", "q.elbwo"),
        "bad.csv: expected a column 'q.elbow'.*nearest: 'q.elbwo'",
    ),
    "typing error": (renamed("tau.elbow", "tua.elbow"), "'tua.elbow'.*'tau.elbow' is meant"),
    "typing error, other separator": (
        renamed("tau.elbow", "torqeu_elbow"),
        "'torqeu_elbow'.*'tau.elbow' is meant.*columns: {tau.elbow",
    ),
    "twice": (renamed("tau.elbow", "q.elbow"), "column 'q.elbow' is there more than once"),
    "backwards": (with_time(swapped), r"backwards in data row 401: 3\.000000 s after 3\.990000 s"),
    "standing": (with_time(lambda t: np.round(t, 1)), "719 of 800 rows have the stamp of the one"),
    "milliseconds": (with_time(lambda t: 1e3 * t), "10 s apart; if column 'time' is in ms"),
    "nanoseconds": (with_time(lambda t: 1.7e18 + 1e9 * t), "if column 'time' is in ns"),
    "no times": (with_time(lambda t: np.full_like(t, np.nan)), "'time' holds no numbers"),
    "no positions": (lambda t: t.assign(**{"q.elbow": np.nan}), "'q.elbow' has 0 numbers"),
    "no numbers": (
        lambda t: t.assign(**{"q.elbow": ["fine"] + ["1.0"] * 799}),
        "bad.csv: column 'q.elbow':.*fine",
    ),
    "short": (lambda t: t[:150], r"lasts 1\.49 s, expected at least 2 s: .* too short"),
    "few": (lambda t: t[::20], "40 samples, expected at least 50"),
    "empty": (lambda t: t[:0], "bad.csv: no rows"),
    "still": (
        lambda t: t.assign(**{"q.elbow": 0.1, "q.shoulder": 0.2}),
        "bad.csv: no joint moves by more than 0.002 rad",
    ),
    "half a tip": (lambda t: t.assign(**{"tip.x": 0.0, "tip.y": 0.0}), "tip.*missing: tip.z"),
    "no quaternion": (
        lambda t: t.assign(**{f"tip.{c}": 1.0 for c in ("x", "y", "z", "qw", "qx", "qy", "qz")}),
        "quaternion .* has norm 2, expected 1",
    ),
    "degrees": (scaled("q.", DEGREES), r"is 'q' in deg\?.*'units: {q: deg}' or"),
    "all degrees": (
        lambda t: scaled("dq.", DEGREES)(scaled("q.", DEGREES)(t)),
        "is 'q' in deg.*q.shoulder goes from .*limits are -3 to 3 rad",
    ),
    "degrees per second": (scaled("dq.", DEGREES), r"is 'dq' in deg/s\?.*57.3 times the rate"),
    "rpm": (scaled("dq.", 30 / np.pi), r"is 'dq' in rpm\?"),
    "commanded degrees": (
        lambda t: t.assign(**{f"q_des.{j}": DEGREES * t[f"q.{j}"] for j in JOINTS}),
        r"is 'q_des' in deg\?",
    ),
    "mN m": (scaled("tau.", 1e3), r"is 'tau' in mN.m\?.*gravity asks for"),
    "N cm": (scaled("tau.", 1e2), r"is 'tau' in N.cm\?.*gravity asks for"),
    "tip in mm": (
        lambda t: t.assign(**{"tip.x": 300.0 + 100 * t["time"], "tip.y": 0.0, "tip.z": 0.0}),
        r"is 'tip' in mm\?",
    ),
}


@pytest.mark.parametrize("fault", LOGS)
def test_what_is_wrong_with_a_recording_is_said(tmp_path: Path, fault: str) -> None:
    change, message = LOGS[fault]
    path = write_study(tmp_path)
    table = change(log())
    table.to_csv(tmp_path / "bad.csv", index=False)
    path.write_text(path.read_text().replace("a.csv", "bad.csv"))
    with pytest.raises(LoadError, match=message):
        load_study(path)


@pytest.mark.parametrize(
    ("units", "change"),
    [
        ({"q": "rad"}, lambda t: scaled("dq.", 9)(scaled("q.", 9)(t))),
        ({"dq": "rad/s"}, scaled("dq.", DEGREES)),
        ({"tau": "N.m"}, scaled("tau.", 1e3)),
        ({"time": "s"}, lambda t: with_time(lambda t: 60 * t)(t.filter(regex="^(time|q)"))),
    ],
)
def test_a_unit_that_the_study_names_is_believed(
    tmp_path: Path, units: dict[str, str], change: Callable[[pd.DataFrame], pd.DataFrame]
) -> None:
    with pytest.raises(LoadError, match=r"units: \{"):
        load_study(write_study(tmp_path, {"a.csv": change(log())}))
    assert load_study(write_study(tmp_path, {"a.csv": change(log())}, units=units)).fit


@given(
    gain=st.floats(0.4, 2.5), payload=st.floats(0, 5), friction=st.floats(0, 3), seed=st.integers(0)
)
def test_faults_of_a_robot_are_no_mistaken_units(
    tmp_path_factory: pytest.TempPathFactory,
    gain: float,
    payload: float,
    friction: float,
    seed: int,
) -> None:
    time = np.arange(800) / 100
    table = columns(time)
    for joint in JOINTS:
        torque = table[f"tau.{joint}"] * (1 + payload) + friction * np.sign(table[f"dq.{joint}"])
        table[f"tau.{joint}"] = gain * torque
        noise = np.random.default_rng(seed).normal(size=len(time))
        table[f"dq.{joint}"] = np.sqrt(gain) * table[f"dq.{joint}"] + 0.05 * noise
    folder = tmp_path_factory.mktemp("study")
    assert load_study(write_study(folder, {"a.csv": pd.DataFrame(table)})).fit


def test_friction_far_above_gravity_is_no_mistaken_unit(tmp_path: Path) -> None:
    table = log()
    for joint in JOINTS:
        table[f"tau.{joint}"] = table[f"tau.{joint}"] / 200 + 5 * np.sign(table[f"dq.{joint}"])
    light = URDF.replace('mass value="2"', 'mass value="0.01"').format(mass=0.005)
    assert load_study(write_study(tmp_path, {"a.csv": table}, light)).fit


def test_columns_of_no_interest_can_be_passed_over(tmp_path: Path) -> None:
    table = log().assign(**{"torqe.elbow": 1.0, "temperature.elbow": 40.0, "battery": 12.0})
    assert load_study(write_study(tmp_path, {"a.csv": table})).fit  # tau.elbow is there
    table = table.drop(columns="tau.elbow")
    with pytest.raises(LoadError, match=r"ignore: \[torqe.elbow\]"):
        load_study(write_study(tmp_path, {"a.csv": table}))
    assert load_study(write_study(tmp_path, {"a.csv": table}, ignore=["torqe.elbow"])).fit


KEYS: dict[str, tuple[dict[str, Any], str]] = {
    "unknown": ({"robots": "arm.urdf"}, "study.yaml: unknown key 'robots'; nearest: 'robot'"),
    "entry": ({"recordings": [{"fle": "a.csv"}]}, r"recordings\[0\]: unknown key 'fle'.*'file'"),
    "none": ({"recordings": []}, "expected 'recordings:' with at least one"),
    "role": (
        {"recordings": [{"file": "a.csv", "role": "test"}]},
        "expected fit or validate.*'test'",
    ),
    "no fit": (
        {"recordings": [{"file": "a.csv", "role": "validate"}]},
        "none has 'role: fit'",
    ),
    "same": ({"recordings": ["a.csv", "a.csv"]}, "a.csv is listed more than once"),
    "no file": ({"recordings": ["aa.csv"]}, "aa.csv: no such file: .*nearest: 'a.csv'"),
    "topic": (
        {"recordings": [{"file": "a.csv", "topic": "/q"}]},
        "topic: is of a ROS bag only, this file is CSV",
    ),
    "window": ({"recordings": [{"file": "a.csv", "window": [3, 1]}]}, "expected .from, to."),
    "outside": ({"recordings": [{"file": "a.csv", "window": [50, 60]}]}, "no rows in the window"),
    "every": ({"recordings": [{"file": "a.csv", "every": 0}]}, "every: expected at least 1, got 0"),
    "joints": (
        {"joints": ["shoulder", "elbows"]},
        "no joint 'elbows' that moves; nearest: 'elbow'",
    ),
    "fixed": ({"joints": ["flange"]}, "no joint 'flange' that moves"),
    "twice": ({"joints": ["elbow", "elbow"]}, "'elbow' is there more than once"),
    "tip": ({"tip": "tol"}, "no link 'tol' .*; nearest: 'tool'"),
    "robot": ({"robot": "arms.urdf"}, "robot: no such file: .*nearest: 'arm.urdf'"),
    "gains": (
        {"controller": {"kp": [1, 2, 3], "kd": [1, 2]}},
        "controller: kp has 3 entries, expected 2: the study has 2 joints",
    ),
    "sign": ({"controller": {"kp": [1, -2], "kd": [0, 0]}}, "none negative, got -2 for elbow"),
    "word": ({"controller": {"kp": [1, "x"], "kd": [0, 0]}}, "kp: expected a number, got 'x'"),
    "named": ({"controller": {"kp": {"elbo": 1}, "kd": [0, 0]}}, "unknown key 'elbo'; nearest"),
    "type": ({"controller": {"type": "pie"}}, "type: expected one of .*cascade.*, got 'pie'"),
    "period": ({"controller": {"kp": [1, 1], "kd": [1, 1], "period": 0}}, "more than 0, got 0"),
    "gravity": (
        {"controller": {"kp": [1, 1], "kd": [1, 1], "gravity_compensation": "on it"}},
        "expected true or false",
    ),
    "trust": ({"trust": {"rigid": 0.1}}, "trust: unknown key 'rigid'; nearest: 'rigid_body'"),
    "inertia": ({"rotor_inertia": [0.1]}, "rotor_inertia has 1 entries, expected 2"),
    "unit": ({"units": {"q": "degrees"}}, "units: q: no unit 'degrees'; expected one of rad, deg"),
    "channel": ({"units": {"qq": "deg"}}, "units: no channel 'qq'; nearest: 'q'"),
}


@pytest.mark.parametrize("fault", KEYS)
def test_what_is_wrong_with_a_key_is_said(tmp_path: Path, fault: str) -> None:
    keys, message = KEYS[fault]
    with pytest.raises(LoadError, match=message):
        load_study(write_study(tmp_path, **keys))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("recordings: [a.csv", "study.yaml: no YAML"),
        ("- a.csv\n", "expected 'key: value' lines"),
        ("", "expected 'key: value' lines, got None"),
    ],
)
def test_what_is_no_study_is_said(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "study.yaml").write_text(text)
    with pytest.raises(LoadError, match=message):
        load_study(tmp_path / "study.yaml")
    with pytest.raises(LoadError, match=r"cannot read .*none\.yaml"):
        load_study(tmp_path / "none.yaml")
    with pytest.raises(LoadError, match="expected a YAML file, got the folder"):
        load_study(tmp_path)


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (
            URDF.format(mass=0).replace('value="2"', 'value="0"'),
            "none of the joints shoulder, elbow moves any mass",
        ),
        (URDF.format(mass=-1), "link 'fore' has a mass of -1 kg"),
        (URDF.format(mass="heavy"), "link 'fore': mass: value='heavy' is no number"),
        (URDF[:300] + "<robot>", "arm.urdf: no XML"),
        ("<robots><!-- <robot --></robots>", "expected a URDF .* or MJCF .*, got <robots>"),
        (MJCF.format(mass="1e-30"), "MuJoCo cannot read it"),
    ],
)
def test_what_is_wrong_with_a_robot_is_said(tmp_path: Path, model: str, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        load_study(write_study(tmp_path, None, model))


def test_links_without_mass_before_others_with_are_noted(tmp_path: Path) -> None:
    model = URDF.format(mass=1).replace('<mass value="2"/>', '<mass value="0"/>')
    notes = load_study(write_study(tmp_path, None, model)).notes
    assert any("link upper has no mass" in note for note in notes)


def test_recordings_of_different_joints_have_nothing_in_common(tmp_path: Path) -> None:
    other = log().rename(
        columns=lambda name: name.replace("shoulder", "hip").replace("elbow", "knee")
    )
    with pytest.raises(LoadError, match=r"a.csv: shoulder, elbow; b.csv: hip, knee"):
        load_study(write_study(tmp_path, {"a.csv": log(), "b.csv": other}, None, joints=None))
    with pytest.raises(LoadError, match=r"no joint 'hip' that moves"):
        load_study(write_study(tmp_path, {"a.csv": other}, joints=None))


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_file_larger_than_memory_is_not_read(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    table, name = log(60.0), f"long.{suffix}"
    table.to_csv(tmp_path / name, index=False) if suffix == "csv" else table.to_parquet(
        tmp_path / name
    )
    kind = KINDS["CSV" if suffix == "csv" else "Parquet"]
    with monkeypatch.context() as patch:
        patch.setattr(kind, "pieces", lambda *_: pytest.fail("it was read"))
        with pytest.raises(
            LoadError, match=rf"{name}: about .* rows, expected at most 1,000;.*every"
        ):
            load_study(write_study(tmp_path, {}, recordings=[name], max_rows=1000))
    entry = {"file": name, "every": 6}
    assert load_study(write_study(tmp_path, {}, recordings=[entry], max_rows=1010)).fit
    entry = {"file": name, "window": [10, 40]}
    with pytest.raises(LoadError, match="expected at most 1,000"):
        load_study(write_study(tmp_path, {}, recordings=[entry], max_rows=1000))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "a.csv: empty"),
        (
            b"0.0,0.1,0.2\n0.1,0.1,0.2\n",
            "the first line holds numbers, expected the columns' names",
        ),
        (b"\xff\xfe\x00\x01\n", "no CSV text"),
        (b"time,q.elbow,q.shoulder\n" + b"1,2\n" * 100, "100 of 100 rows have another number of"),
    ],
)
def test_what_is_no_table_is_said(tmp_path: Path, text: bytes, message: str) -> None:
    (tmp_path / "a.csv").write_bytes(text)
    with pytest.raises(LoadError, match=message):
        load_study(write_study(tmp_path, {}, recordings=["a.csv"]))
    (tmp_path / "a.parquet").write_bytes(text)
    with pytest.raises(LoadError, match="no Parquet file"):
        load_study(write_study(tmp_path, {}, recordings=["a.parquet"]))
