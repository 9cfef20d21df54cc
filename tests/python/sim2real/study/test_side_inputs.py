"""What a study may bring besides torques: currents, and the user's own simulation."""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("rosbags", reason="the extra sim2real is not installed")

from pdoik import sim2real

N_M_PER_A = 12.5


@pytest.fixture
def study(example_study: Path, tmp_path: Path) -> Path:
    """A copy of the example's folder to change."""
    folder = tmp_path / "study"
    shutil.copytree(example_study.parent, folder)
    return folder / "study.yaml"


def test_currents_become_torques_by_constants_that_are_told(study: Path) -> None:
    for path in study.parent.glob("*.csv"):
        table = pd.read_csv(path)
        torques = [name for name in table if name.startswith("tau.")]
        table[torques] /= N_M_PER_A
        names = {name: name.replace("tau.", "current.") for name in torques}
        table.drop(columns=[name for name in table if name.startswith("tau_cmd")]).rename(
            columns=names
        ).to_csv(path, index=False)
    text = study.read_text()
    begin, end = text.index("controller:"), text.index("rotor_inertia:")
    study.write_text(text[:begin] + text[end:])
    diagnosis = sim2real.diagnose(study)
    (note,) = [note for note in diagnosis.notes if "[N m/A]" in note]
    told = float(note.split("base ")[1].split(",")[0].rstrip("."))
    assert 0.5 * N_M_PER_A < told < 1.5 * N_M_PER_A  # what the hand holds takes part of it
    assert any(finding.effect == "coulomb_friction" for finding in diagnosis.findings)


def test_a_simulation_of_another_model_is_told(study: Path) -> None:
    text = study.read_text()
    study.write_text(text + "simulation: [friday.csv]\n")  # the machine itself: not the model
    notes = sim2real.diagnose(study).notes
    assert any("not of the given model" in note and "elbow" in note for note in notes)


def test_a_simulation_of_the_given_model_is_told(study: Path) -> None:
    loaded = sim2real.load_study(study)
    model = sim2real.Model.of_study(loaded, ())
    replayed = sim2real.replay(model, loaded.validate[0], findings=False)
    assert replayed.tau is not None
    columns = {"time": replayed.time}
    for j, name in enumerate(loaded.joints):
        columns[f"q.{name}"] = replayed.q[:, j]
        columns[f"tau.{name}"] = replayed.tau[:, j]
    pd.DataFrame(columns).to_csv(study.parent / "sim.csv", index=False)
    study.write_text(study.read_text() + "simulation: [sim.csv]\n")
    notes = sim2real.diagnose(study).notes
    assert any("obeys the given model" in note for note in notes)
    assert np.isfinite(replayed.tau).all()
