"""A body whose figures are each unclear, while what they do together is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")

from bench.sim2real.concealed.build import hidden_in, make_study, write_machine
from bench.sim2real.concealed.draft import draft_of
from bench.sim2real.concealed.spec import WorldSpec
from creeping import creeping
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


def test_a_body_that_all_sessions_bear_out_stays_though_slow_ones_make_its_figures_unclear(
    tmp_path: Path,
) -> None:
    """Where the arm only creeps, next to nothing is told of ten figures: they differ by a lot."""
    draft = draft_of(
        WorldSpec(seed=8202, effect="link_inertial_error", hide="noise", robot="random2")
    )
    effects = hidden_in(draft)
    motions, roles = [*creeping(draft), draft.motions[0]], ["fit", "validate", "fit"]
    draft = replace(draft, motions=motions, roles=roles, sensors=replace(draft.sensors, tip=False))
    (tmp_path / "study").mkdir()
    write_machine(tmp_path / "study", draft, effects)
    diagnosis = examine(tmp_path / "study" / "study.yaml").diagnosis
    (body,) = diagnosis.findings
    assert body.effect == "link_inertial_error"
    assert body.links == ("link2",)
    assert body.support is not None
    assert body.support.agree == body.support.sessions
    assert all(abs(each.value) < 2.0 * each.std for each in body.parameters.values())
    assert "None of its figures is clear by itself" in body.statement
