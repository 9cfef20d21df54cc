"""A real UR10, watched by a model of one half of its recording: the other half is no alarm."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pyarrow", reason="pip install 'pdoik[sim2real]'")

import pdoik
from pdoik.sim2real import Watch, examine, load_study, model_of

BESIDE = Path(__file__).resolve().parents[5] / "shared"
RUN = Path(os.environ.get("PDOIK_SHARED", BESIDE)) / "recordings/ur10_unisa/run1.csv"
NAMES = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


def study(folder: Path, *windows: tuple[float, float]) -> Path:
    if not RUN.is_file():
        pytest.skip("needs recordings/ur10_unisa from the shared material (PDOIK_SHARED)")
    head, *rows = RUN.read_text().splitlines()
    entries = []
    for k, (first, last) in enumerate(windows):
        part = rows[int(first * len(rows)) : int(last * len(rows))]
        (folder / f"{k}.csv").write_text("\n".join([head, *part]) + "\n")
        entries.append({"file": f"{k}.csv", "role": "fit"})
    path = folder / "study.yaml"
    content = {
        "robot": str(Path(pdoik.__file__).parent / "robots" / "ur10.urdf"),
        "joints": [f"{name}_joint" for name in NAMES],
        "recordings": entries,
    }
    path.write_text(yaml.safe_dump(content))
    return path


def test_what_a_ur10_does_later_is_no_alarm_and_a_torque_that_is_off_is(tmp_path: Path) -> None:
    model = model_of(examine(study(tmp_path, (0.0, 0.35), (0.35, 0.7))))
    (tmp_path / "later").mkdir()
    later = load_study(study(tmp_path / "later", (0.7, 1.0))).fit[0]
    watch = Watch(model)
    assert watch.feed(later) + watch.end() == []
    assert later.tau is not None
    off = later.tau.copy()
    off[later.time > 4.0, 0] += 20.0  # [N m], about the joint's friction
    watch = Watch(model)
    alarms = watch.feed(replace(later, tau=off)) + watch.end()
    assert alarms[0].joint == "shoulder_pan_joint"
    assert np.abs(alarms[0].onset - later.start - 4.0) < 1.0
