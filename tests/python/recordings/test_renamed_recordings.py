"""Real recordings, under the names and in the kinds of files in which such machines log them."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from pdoik.sim2real.study import Study, load_study

BESIDE = Path(__file__).resolve().parents[4] / "shared"
RECORDINGS = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings"

RTDE = {"q": "actual_q", "dq": "actual_qd", "tau": "actual_joint_torque", "q_des": "target_q"}
PATHS = {"q": "position", "dq": "velocity", "tau": "effort"}
GO2 = {"q": "motor_state/{}/q [deg]", "q_des": "motor_cmd/{}/q [deg]"}
SHORT = {"q": "pos", "dq": "vel", "tau": "torque", "tau_cmd": "des_torque"}
SERVO = {"q": "present_position", "dq": "present_velocity", "q_des": "goal_position", "duty": "PWM"}


def in_order(words: dict[str, str]) -> Callable[[str, str, int], str]:
    return lambda channel, joint, k: f"{words[channel]}_{k}"


def in_paths(channel: str, joint: str, k: int) -> str:
    return f"/joint_states/{joint}/{PATHS[channel]}"


CASES: dict[str, tuple[str, str, Callable[[str, str, int], str]]] = {
    "UR's RTDE": ("ur10_unisa/run1.csv", "timestamp", in_order(RTDE)),
    "PlotJuggler": ("panda_unisa/run1.csv", "__time", in_paths),
    "ROS by fields": (
        "panda_unisa/run1.csv",
        "Time [s]",
        lambda channel, joint, k: f"{PATHS[channel]}.{joint}",
    ),
    "joint first": (
        "dfki_double_pendulum/run1.csv",
        "t",
        lambda channel, joint, k: f"{joint}_{SHORT[channel]}",
    ),
    "SDK in degrees": (
        "go2_hanging/run1.csv",
        "stamp",
        lambda channel, joint, k: GO2[channel].format(joint),
    ),
    "without the common word": (
        "go2_hanging/run1.csv",
        "time_s",
        lambda channel, joint, k: f"{joint.removesuffix('_joint')}.{channel.replace('q', 'pos')}",
    ),
    "camels": (
        "so101_sage/multisine.csv",
        "time",
        lambda channel, joint, k: f"{joint.title().replace('_', '')}{channel.title()}",
    ),
    "servo": (
        "bam_xl330/kp400_sin_sin.csv",
        "time",
        lambda channel, joint, k: f"{SERVO[channel]}_{joint}",
    ),
}


def load(folder: Path, file: Path, joints: list[str]) -> Study:
    path = folder / f"{file.stem}.yaml"
    path.write_text(yaml.safe_dump({"joints": joints, "recordings": [file.name]}))
    return load_study(path)


@pytest.mark.parametrize("case", CASES)
def test_other_names_give_the_same_recording(tmp_path: Path, case: str) -> None:
    source, time, name = CASES[case]
    if not (RECORDINGS / source).is_file():
        pytest.skip("needs the recordings of the shared material (PDOIK_SHARED or ../shared)")
    table = pd.read_csv(RECORDINGS / source)
    table.to_csv(tmp_path / "plain.csv", index=False)
    joints = [column[2:] for column in table if column.startswith("q.")]
    names = {"time": time, "volts": "supply voltage [V]"}
    for column in table:
        channel, _, joint = column.partition(".")
        if joint:
            names[column] = name(channel, joint, joints.index(joint))
            if "[deg]" in names[column]:
                table[column] = np.degrees(table[column])
    renamed = table.rename(columns=names).sample(frac=1, axis=1, random_state=3)  # in any order
    assert not set(renamed) & {column for column in table if "." in column}
    renamed.to_csv(tmp_path / "renamed.csv", index=False)
    plain = load(tmp_path, tmp_path / "plain.csv", joints)
    other = load(tmp_path, tmp_path / "renamed.csv", joints)
    for expected, recording in zip(plain.recordings, other.recordings, strict=True):
        assert recording.channels == expected.channels
        assert np.array_equal(recording.time, expected.time)
        for channel in expected.channels:
            values = getattr(recording, channel), getattr(expected, channel)
            assert np.allclose(*values, atol=1e-12, equal_nan=True)
    assert any("read as q." in note for note in other.notes)
