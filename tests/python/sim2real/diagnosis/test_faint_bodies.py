"""A body that is a small share of the arm: whether it is named depends on trust in the model."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import WorldSpec
from pdoik.sim2real import examine

SPEC = WorldSpec(seed=9005, effect="payload", hide="second", robot="random2")


def trusting(study: Path, share: float) -> Path:
    """A study whose model is right to such a share."""
    content = yaml.safe_load(study.read_text())
    study.write_text(yaml.safe_dump({**content, "trust": {"rigid_body": share}}))
    return study


def test_a_load_of_less_than_a_tenth_of_the_arm_is_named_where_the_model_is_trusted(
    tmp_path: Path,
) -> None:
    """Masses are a tenth off in many models: only the user knows that these are not."""
    truth = make_study(tmp_path / "study", SPEC, tmp_path / "truth")
    hidden = next(each for each in truth.effects if each["role"] == "hidden")["parameters"]
    study = tmp_path / "study" / "study.yaml"
    usual = examine(study).diagnosis
    assert not any(each.links for each in usual.findings)
    assert any("adjusted within 10 %" in note for note in usual.notes)
    diagnosis = examine(trusting(study, 0.01)).diagnosis
    assert diagnosis.verdict == "mismatch_explained"
    body = next(each for each in diagnosis.findings if each.links)
    assert body.links == ("link2",)
    assert {body.effect, *(each.effect for each in body.equivalents)} >= {"payload"}
    figures = body.parameters
    for axis in "xyz":
        low, high = figures[f"d_first_moment_{axis}"].interval95
        assert low < hidden["mass"] * hidden[f"com_{axis}"] < high
    for found in (usual, diagnosis):
        for joint in found.joints.values():
            assert joint.after < 1.6 * joint.noise_floor
