"""Pushes that only a recording held out shows, and what looks like one there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

import pinocchio as pin

from bench.sim2real.concealed.build import hidden_in, write_machine
from bench.sim2real.concealed.draft import draft_of
from bench.sim2real.concealed.spec import WorldSpec
from creeping import creeping
from pdoik.sim2real import Finding, examine

PUSH = np.array([6.0, -8.0, 5.0])  # [N]
WINDOW = (3.0, 5.0)  # [s]


@pytest.fixture(scope="module")
def leaning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base that leans by a degree, in two recordings that show too little to be sure of it."""
    draft = draft_of(
        WorldSpec(seed=8206, effect="gravity_direction", hide="noise", robot="random2")
    )
    sensors = replace(draft.sensors, tip=False)
    poor = replace(draft, motions=creeping(draft), roles=["fit", "validate"], sensors=sensors)
    folder = tmp_path_factory.mktemp("study")
    write_machine(folder, poor, hidden_in(draft))
    return folder


def pushes(study: Path) -> list[Finding]:
    diagnosis = examine(study / "study.yaml").diagnosis
    said = (*diagnosis.findings, *diagnosis.suspected)
    return [each for each in said if each.effect == "external_contact"]


def test_what_too_little_speaks_for_is_no_push_in_the_recording_held_out(leaning: Path) -> None:
    """It had been one of half a newton, from the first row to the last."""
    diagnosis = examine(leaning / "study.yaml").diagnosis
    assert diagnosis.findings == ()
    assert {each.effect for each in diagnosis.suspected} <= {"gravity_direction"}


@pytest.mark.parametrize(("window", "found"), [(WINDOW, True), ((0.0, 9.0), False)])
def test_a_push_begins_or_ends(
    leaning: Path, tmp_path: Path, window: tuple[float, float], found: bool
) -> None:
    """One that lasts all recording long is the model that fails there, or a load."""
    for file in leaning.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    log = pd.read_csv(tmp_path / "rec2.csv")
    model = pin.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    names = list(model.names)[1:]
    tip = model.getFrameId("tool")
    for row in np.flatnonzero((log.time >= window[0]) & (log.time < window[1])):
        q = log.loc[row, [f"q.{name}" for name in names]].to_numpy(dtype=np.float64)
        jacobian = pin.computeFrameJacobian(
            model, model.createData(), q, tip, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        for name, torque in zip(names, jacobian[:3].T @ PUSH, strict=True):
            log.loc[row, f"tau.{name}"] -= torque
    log.to_csv(tmp_path / "rec2.csv", index=False)
    said = pushes(tmp_path)
    assert len(said) == found
    for each in said:
        assert each.held_out_only
        assert each.recordings == ("rec2.csv",)
        assert each.window == pytest.approx(window, abs=0.2)
