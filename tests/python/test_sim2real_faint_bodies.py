"""A body whose figures are each unclear, while what they do together is not."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

from bench.concealed.build import make_study
from bench.concealed.spec import WorldSpec

from pdoik.sim2real import examine

SPEC = WorldSpec(seed=9005, effect="payload", hide="second", robot="random2")


def test_a_load_of_which_no_single_figure_is_clear_is_found_by_what_it_does(tmp_path: Path) -> None:
    truth = make_study(tmp_path / "study", SPEC, tmp_path / "truth")
    hidden = next(each for each in truth.effects if each["role"] == "hidden")["parameters"]
    diagnosis = examine(tmp_path / "study" / "study.yaml").diagnosis
    assert diagnosis.verdict == "mismatch_explained"
    body = next(each for each in diagnosis.findings if each.effect == "link_inertial_error")
    assert body.links == ("link2",)
    assert any(each.effect == "payload" for each in body.equivalents)
    figures = body.parameters
    assert all(abs(each.value) < 2.0 * each.std for each in figures.values())
    for axis in "xyz":
        low, high = figures[f"d_first_moment_{axis}"].interval95
        assert low < hidden["mass"] * hidden[f"com_{axis}"] < high
    for joint in diagnosis.joints.values():
        assert joint.after < 1.6 * joint.noise_floor
    assert diagnosis.joints["joint2"].before > 5.0 * diagnosis.joints["joint2"].noise_floor
