"""The whole arm simulated from its commands: what it leaves, and what it teaches."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from bench.sim2real.concealed.build import make_study
from bench.sim2real.concealed.spec import Truth, WorldSpec
from pdoik.sim2real import diagnose, load_study
from pdoik.sim2real.confirm import (
    Arm,
    Rollout,
    confirmed_by_simulation,
    refine_by_rollouts,
    why_not,
)
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import identify
from pdoik.sim2real.motion import Place, Prepared, prepare
from pdoik.sim2real.regression import Fit, Term, refined, term_of
from pdoik.sim2real.simulation import SimulationError, Stepper


def hidden(folder: Path, effect: str, seed: int, robot: str) -> tuple[Truth, Path]:
    spec = WorldSpec(seed=seed, effect=effect, hide="plain", robot=robot)
    return make_study(folder / "study", spec, folder / "truth"), folder / "study" / "study.yaml"


@pytest.fixture(scope="module")
def springy(tmp_path_factory: pytest.TempPathFactory) -> tuple[Truth, Prepared]:
    truth, file = hidden(tmp_path_factory.mktemp("springy"), "joint_elasticity", 12, "random3")
    return truth, prepare(load_study(file))


@pytest.fixture(scope="module")
def spring(springy: tuple[Truth, Prepared]) -> tuple[Arm, Term, dict[str, float]]:
    """The arm, the hidden spring's term, and its true figures."""
    truth, prepared = springy
    figures = truth.effects[0]["parameters"]
    effect = CATALOGUE["joint_elasticity"]
    place = Place(joints=(prepared.study.joints.index(truth.effects[0]["joints"][0]),))
    term = term_of(prepared.fit, effect, place, effect.coefficients(figures)[0])
    assert term is not None
    return Arm(prepared, Fit(prepared.fit, ()), steps=20_000), term, figures


def test_a_simulation_with_what_is_hidden_leaves_noise(
    spring: tuple[Arm, Term, dict[str, float]],
) -> None:
    arm, term, figures = spring
    right = arm.run([term], [figures])
    stiff = arm.run([term], [{**figures, "stiffness": 50.0 * figures["stiffness"]}])
    assert right.cost < 2.0
    assert stiff.cost > 3.0 * right.cost
    assert set(right.left) == set(arm.rows)


def test_wrong_figures_are_moved_to_the_true_ones(
    spring: tuple[Arm, Term, dict[str, float]],
) -> None:
    arm, term, figures = spring
    wrong = {"stiffness": 1.3 * figures["stiffness"], "damping": 0.5 * figures["damping"]}
    errors = {name: 0.05 * value for name, value in figures.items()}
    first, best = refine_by_rollouts(arm, [term], [wrong], [errors])
    assert first.values[0] == wrong
    assert best.cost < 0.8 * first.cost
    assert best.values[0]["stiffness"] == pytest.approx(figures["stiffness"], rel=0.03)
    off = abs(best.values[0]["damping"] - figures["damping"])
    assert off <= abs(wrong["damping"] - figures["damping"])  # barely visible


def test_what_is_left_counts_linearly_where_it_is_far() -> None:
    left = np.array([0.0, 1.0, -3.0, 40.0])
    rollout = Rollout(values=(), left={("torque", 0): left}, touched=frozenset({("torque", 0)}))
    assert rollout.cost == pytest.approx((0.0 + 1.0 + 9.0 + 4.0 * (2 * 40.0 - 4.0)) / 4)
    elsewhere = Rollout(values=(), left={("law", 0): left}, touched=frozenset({("torque", 0)}))
    assert elsewhere.cost == 0.0


def test_play_is_named_measured_and_confirmed_by_simulation(tmp_path: Path) -> None:
    truth, file = hidden(tmp_path, "backlash", 5950, "h1_arm")
    found = diagnose(file)
    assert [finding.effect for finding in found.findings] == ["backlash"]
    finding, figures = found.findings[0], truth.effects[0]["parameters"]
    assert list(finding.joints) == truth.effects[0]["joints"]
    assert finding.values["gap"] == pytest.approx(figures["gap"], rel=0.15)
    low, high = finding.parameters["gap"].interval95
    assert low < figures["gap"] < high
    assert any("refined by simulating" in note for note in found.notes)


@pytest.mark.long
def test_play_that_was_taken_for_a_spring_is_named_by_simulation(tmp_path: Path) -> None:
    _, file = hidden(tmp_path, "backlash", 5950, "h1_arm")
    prepared = prepare(load_study(file))
    prepared, state = identify(prepared, lambda *said: None)
    (play,) = (term for term in state.accepted if term.effect == "backlash")
    effect, others = CATALOGUE["joint_elasticity"], [t for t in state.accepted if t is not play]
    shape = effect.shapes(prepared.fit.motions, play.place)[0]
    spring = term_of(prepared.fit, effect, play.place, shape)
    assert spring is not None
    beside = [*state.nuisance, *others]
    wrong = state.fitted([*beside, refined(Fit(state.balances, beside), spring)])
    said: list[str] = []
    state = confirmed_by_simulation(prepared, wrong, 0, said.append)
    assert "backlash" in {term.effect for term in state.accepted}
    assert "joint_elasticity" not in {term.effect for term in state.accepted}
    assert any("in the place of joint elasticity" in line for line in said), said


def test_nothing_is_simulated_where_nothing_is_known_to_command_it(
    springy: tuple[Truth, Prepared],
) -> None:
    study = springy[1].study
    assert why_not(study) == ""
    assert "controller" in why_not(replace(study, controller=None))
    assert "robot" in why_not(replace(study, robot=None))
    mute = tuple(replace(recording, q_des=None) for recording in study.recordings)
    assert "q_des" in why_not(replace(study, recordings=mute))
    gap = np.where(np.arange(3) == 1, np.nan, np.asarray(study.recordings[0].q_des))
    some = (replace(study.recordings[0], q_des=gap), *study.recordings[1:])
    assert "every joint" in why_not(replace(study, recordings=some))
    with pytest.raises(ValueError, match="no controller is known"):
        Arm(
            replace(springy[1], study=replace(study, controller=None)),
            Fit(springy[1].fit, ()),
        )


def run(stepper: Stepper, torque: np.ndarray) -> None:
    for _ in range(200):
        stepper.step(torque)


def test_a_simulation_that_breaks_says_so_and_writes_no_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, springy: tuple[Truth, Prepared]
) -> None:
    monkeypatch.chdir(tmp_path)
    study = springy[1].study
    assert study.robot is not None
    stepper = Stepper(study.robot, study.joints)
    with pytest.raises(SimulationError):  # at the first step or soon after
        run(stepper, np.full(len(study.joints), 1e12))
    assert list(tmp_path.iterdir()) == []
