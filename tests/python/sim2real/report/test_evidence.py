"""What a report is given agrees with the diagnosis, and the files agree with both."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("jinja2", reason="pip install 'pdoik[sim2real]'")

import mujoco

from bench.sim2real import example
from pdoik.sim2real import (
    Diagnosis,
    evidence_of,
    examine,
    load_model,
    load_study,
    model_of,
    predict,
    write,
)
from pdoik.sim2real.regression import TRUST
from pdoik.sim2real.report import ReportData


@pytest.fixture(scope="module")
def data(examination: Any) -> ReportData:
    return evidence_of(examination)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def test_the_example_is_diagnosed_as_it_was_made(examination: Any) -> None:
    found = {finding.effect: finding for finding in examination.diagnosis.findings}
    assert set(found) == {"payload", "coulomb_friction", "viscous_friction"}
    assert examination.diagnosis.verdict == "mismatch_explained"
    payload, dry, viscous = (
        found[name] for name in ("payload", "coulomb_friction", "viscous_friction")
    )
    assert payload.links == ("forearm",)
    assert dry.joints == viscous.joints == ("elbow",)
    for finding, name, truth in (
        (payload, "mass", example.MASS),
        (payload, "com_x", example.REACH),
        (dry, "level", example.LEVEL),
        (viscous, "coefficient", example.DAMPING),
    ):
        estimate = finding.parameters[name]
        assert estimate.value == pytest.approx(truth, rel=0.03)
        low, high = estimate.interval95
        slack = high - low
        assert low - slack < truth < high + slack


def test_residuals_shown_are_those_of_the_diagnosis(examination: Any, data: ReportData) -> None:
    (held_out,) = data.held_out
    assert held_out.name == "friday.csv"
    for j, fit in enumerate(examination.diagnosis.joints.values()):
        # Between the rows that the diagnosis counts lie samples that it does not.
        assert rms(held_out.before[:, j]) == pytest.approx(fit.before, rel=0.1)
        assert rms(held_out.after[:, j]) == pytest.approx(fit.after, rel=0.15)
        assert data.units[j] == fit.unit


def test_the_parts_of_the_findings_are_nearly_all_that_is_explained(
    examination: Any, data: ReportData
) -> None:
    """What is left is ordinary physics that no finding names: bodies within trust, offsets."""
    for traces in data.recordings:
        assert len(traces.parts) == len(examination.diagnosis.findings)
        explained = traces.before - traces.after
        rest = explained - np.sum(traces.parts, axis=0)
        assert rms(rest) < 0.1 * rms(explained)
        predicted = traces.predicted_after - traces.predicted_before
        assert predicted[np.isfinite(explained)] == pytest.approx(
            explained[np.isfinite(explained)], abs=1e-9
        )


def test_every_hypothesis_is_listed_once_with_what_became_of_it(
    examination: Any, data: ReportData
) -> None:
    names = [(each.effect, each.place) for each in data.hypotheses]
    assert len(set(names)) == len(names)
    accepted = {each.effect for each in data.hypotheses if each.accepted}
    assert accepted == {finding.effect for finding in examination.diagnosis.findings}
    for each in data.hypotheses:
        low, high = each.interval95
        assert low - 1e-9 <= each.score <= high + 1e-9
        assert bool(each.reason) != each.accepted
        if each.accepted:
            assert low > 0.0


def test_replays_with_the_findings_are_a_tenth_as_far_off(data: ReportData) -> None:
    (replay,) = data.replays
    assert replay.recording == "friday.csv"
    assert "closed-loop" in replay.how
    for j in range(3):
        before, after = (
            rms((run - replay.recorded)[:, j]) for run in (replay.before, replay.after)
        )
        assert after < 0.1 * before


def test_the_findings_hold_with_other_filters(data: ReportData) -> None:
    assert data.cutoff is not None
    assert data.cutoff.chosen in data.cutoff.frequency
    assert (np.diff(data.cutoff.frequency) > 0).all()
    assert (data.cutoff.after < 0.25 * data.cutoff.before).all()


def test_quick_leaves_out_what_takes_long(examination: Any) -> None:
    data = evidence_of(examination, quick=True)
    assert data.replays == ()
    assert data.cutoff is None
    assert data.hypotheses


def test_without_a_known_controller_recorded_torque_drives_the_replay(
    examination: Any,
) -> None:
    from pdoik.sim2real.evidence import replays_of

    study = replace(examination.prepared.study, controller=None)
    blind = replace(examination, prepared=replace(examination.prepared, study=study))
    (replay,), _ = replays_of(blind, model_of(blind))
    assert "driven by the reported torque" in replay.how
    assert rms(replay.after - replay.recorded) < rms(replay.before - replay.recorded)


def test_the_files_hold_the_findings(examination: Any, tmp_path: Path) -> None:
    write(tmp_path, examination, quick=True)
    model = load_model(tmp_path)
    assert model.findings == examination.diagnosis.findings
    assert model.cutoff == examination.prepared.cutoff
    loaded = mujoco.MjModel.from_xml_path(str(tmp_path / "improved.xml"))
    elbow = loaded.joint("elbow").dofadr[0]
    assert loaded.dof_frictionloss[elbow] == pytest.approx(example.LEVEL, rel=0.03)
    assert loaded.dof_damping[elbow] == pytest.approx(example.DAMPING, rel=0.05)
    assert loaded.body("forearm").mass[0] == pytest.approx(0.9 + example.MASS, rel=0.02)
    text = (tmp_path / "diagnosis.json").read_text()
    assert Diagnosis.from_json(text) == examination.diagnosis


def test_what_fails_takes_nothing_along(
    examination: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pdoik.sim2real.evidence import files  # inside: writers are made to fail

    def fails(*args: Any, **options: Any) -> Any:
        raise RuntimeError("no body has mass -340 kg")

    monkeypatch.setattr(files, "improved_mjcf", fails)
    monkeypatch.setattr(files, "evidence_of", fails)
    assert write(tmp_path, examination) == tmp_path / "diagnosis.json"
    assert {path.name for path in tmp_path.iterdir()} == {
        "diagnosis.json",
        "improved.urdf",
        "model.json",
    }
    found = Diagnosis.from_json((tmp_path / "diagnosis.json").read_text())
    assert found.findings == examination.diagnosis.findings
    assert found.notes[-2:] == (
        "improved.xml could not be made: no body has mass -340 kg.",
        "The report could not be made: no body has mass -340 kg.",
    )


def test_predicted_torque_comes_down_to_the_noise(examination: Any) -> None:
    model = model_of(examination)
    (recording,) = examination.prepared.study.validate
    for j in range(2):  # at rest, the elbow's friction takes any value
        before, after = (
            rms((recording.tau - predict(model, recording, findings=findings))[50:-50, j])
            for findings in (False, True)
        )
        assert after < 1.2 * example.NOISE_TAU < before


def test_inertias_that_the_study_does_not_trust_are_corrected_in_the_model(
    example_study: Path,
) -> None:
    from pdoik.sim2real import Trust

    study = replace(load_study(example_study), trust=Trust(rigid_body=0.1))
    examined = examine(study)
    model = model_of(examined)
    trusted = [term for term in examined.state.fit.terms if term.effect == TRUST]
    assert set(model.rigid_body) == {"column", "upper_arm", "forearm"}
    assert len(trusted) == 3
    (recording,) = study.validate
    left = recording.tau - predict(model, recording)
    assert rms(left[50:-50, :2]) < 1.2 * example.NOISE_TAU
    assert np.isfinite(model.simulator().replay(recording).q).all()
