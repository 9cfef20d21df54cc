"""The diagnosis of a study is the same, whatever kind of log its recordings are."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml

pytest.importorskip("h5py", reason="pip install 'pdoik[sim2real]'")

import h5py

from pdoik.sim2real import examine
from pdoik.sim2real.motion import prepare
from pdoik.sim2real.study import load_study

JOINTS = ("base", "shoulder", "elbow")
WORDS = {"q": "joint_pos", "q_des": "joint_pos_target", "dq_des": "joint_vel_target", "tau": "tau"}


def arrays(table: pd.DataFrame) -> dict[str, np.ndarray]:
    return {
        word: table[[f"{channel}.{joint}" for joint in JOINTS]].to_numpy()
        for channel, word in WORDS.items()
    } | {"t": table["time"].to_numpy()}


def as_hdf5(table: pd.DataFrame, path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name, values in arrays(table).items():
            file[f"log/{name}"] = values
        file["log"].attrs["joint_names"] = JOINTS


def as_npz(table: pd.DataFrame, path: Path) -> None:
    np.savez(path, **arrays(table), names=np.array(JOINTS))


def as_json(table: pd.DataFrame, path: Path) -> None:
    rows = {name: values.tolist() for name, values in arrays(table).items()}
    count = len(table)
    path.write_text(
        "".join(json.dumps({n: v[k] for n, v in rows.items()}) + "\n" for k in range(count))
    )


def as_csv(table: pd.DataFrame, path: Path) -> None:
    """As a UR's real-time interface names them, times in ms."""
    words = {"q": "actual_q", "q_des": "target_q", "dq_des": "target_qd", "tau": "actual_torque"}
    names = {
        f"{channel}.{joint}": f"{word}_{k}"
        for channel, word in words.items()
        for k, joint in enumerate(JOINTS)
    }
    renamed = table.rename(columns=names | {"time": "timestamp [ms]"})
    renamed["timestamp [ms]"] *= 1000
    renamed.to_csv(path, index=False)


KINDS: dict[str, Callable[[pd.DataFrame, Path], None]] = {
    "h5": as_hdf5,
    "npz": as_npz,
    "jsonl": as_json,
    "csv": as_csv,
}


def rewritten(study: Path, folder: Path, *suffixes: str) -> Path:
    """The study with its recordings as files of these kinds, one after the other."""
    content: dict[str, Any] = yaml.safe_load(study.read_text())
    for entry, suffix in zip(content["recordings"], suffixes, strict=True):
        table = pd.read_csv(study.parent / entry["file"])
        entry["file"] = f"{Path(entry['file']).stem}.{suffix}"
        KINDS[suffix](table, folder / entry["file"])
    (folder / content["robot"]).write_bytes((study.parent / content["robot"]).read_bytes())
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.mark.parametrize("suffix", KINDS)
def test_balances_are_those_of_the_csv(tmp_path: Path, example_study: Path, suffix: str) -> None:
    expected = prepare(load_study(example_study))
    prepared = prepare(load_study(rewritten(example_study, tmp_path, *[suffix] * 3)))
    assert prepared.cutoff == pytest.approx(expected.cutoff)
    assert prepared.validate is not None
    assert expected.validate is not None
    for mine, theirs in ((prepared.fit, expected.fit), (prepared.validate, expected.validate)):
        assert mine.keys == theirs.keys
        for key in theirs.keys:
            assert np.allclose(mine.residual[key], theirs.residual[key], atol=1e-9)


def test_findings_are_those_of_the_csv(
    tmp_path: Path, example_study: Path, examination: Any
) -> None:
    mixed = examine(rewritten(example_study, tmp_path, "h5", "jsonl", "npz"))
    assert mixed.diagnosis.findings
    for mine, theirs in zip(mixed.diagnosis.findings, examination.diagnosis.findings, strict=True):
        assert (mine.effect, mine.joints) == (theirs.effect, theirs.joints)
        assert mine.confidence == pytest.approx(theirs.confidence, abs=1e-6)
        for name, estimate in theirs.parameters.items():
            assert mine.parameters[name].value == pytest.approx(estimate.value, rel=1e-6, abs=1e-9)
