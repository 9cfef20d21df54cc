"""What changes from day to day is a spread: told with its size, and named as nothing else."""

from __future__ import annotations

import functools
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

pytest.importorskip("mujoco", reason="pip install 'pdoik[sim2real]'")
pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.cli.diagnose import print_diagnosis
from pdoik.cli.messages import out
from pdoik.sim2real import Diagnosis, Estimate, Finding, diagnose
from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.infer import within_bounds
from pdoik.sim2real.motion import Balances, Motion, given_sessions
from pdoik.sim2real.regression import Spread, spread_between
from pdoik.sim2real.report import changes_words, joint_state
from pdoik.sim2real.study import Setup
from sim2real_days import Run, write_days
from sim2real_identified import figure, identified, named, ordinary_fit
from sim2real_motions import moved

# Random effects


def test_of_equal_errors_the_spread_is_what_the_variance_has_beyond_them() -> None:
    values, error = np.array([0.4, 1.1, 2.6, 0.9]), 0.3
    found = spread_between(values, np.full(4, error**2), 60)
    assert found.std == pytest.approx(np.sqrt(np.var(values, ddof=1) - error**2))
    assert found.mean == pytest.approx(values.mean())
    assert found.error == pytest.approx(found.std / 2.0)
    assert found.sessions == 4
    Q = np.sum((values - values.mean()) ** 2) / error**2
    assert found.p == pytest.approx(stats.f.sf(Q / 3, 3, 60))


def test_with_the_spread_differences_are_as_large_as_they_should_be() -> None:
    values, variances = np.array([1.0, 1.5, 0.7]), np.array([0.01, 0.04, 0.02])
    found = spread_between(values, variances, 30)
    weight = 1.0 / (variances + found.std**2)
    assert found.mean == pytest.approx(weight @ values / weight.sum())
    assert weight @ (values - found.mean) ** 2 == pytest.approx(2.0)  # Paule and Mandel
    uneven = spread_between(values, 1e-4 * variances, 30)
    assert uneven.std == pytest.approx(values.std(ddof=1), rel=1e-3)
    assert uneven.sessions == 3


@given(st.integers(2, 6), st.integers(0, 10**6), st.floats(0.1, 10.0))
def test_the_order_of_sessions_and_what_says_nothing_do_not_matter(
    count: int, seed: int, scale: float
) -> None:
    rng = np.random.default_rng(seed)
    values, variances = rng.normal(1.0, 0.3, count), rng.uniform(0.01, 0.05, count)
    found = spread_between(values, variances, 40)
    order = rng.permutation(count + 1)
    more = np.append(values, 100.0)[order], np.append(variances, np.inf)[order]
    again = spread_between(*more, 40)
    assert again.std == pytest.approx(found.std)
    assert again.p == pytest.approx(found.p)
    assert again.sessions == found.sessions
    scaled = spread_between(scale * values, scale**2 * variances, 40)
    assert scaled.std == pytest.approx(scale * found.std)
    assert scaled.p == pytest.approx(found.p)


def test_one_session_that_tells_something_has_no_spread() -> None:
    found = spread_between(np.array([2.0, -9.0]), np.array([0.1, np.inf]), 9)
    assert (found.std, found.p, found.sessions, found.mean) == (0.0, 1.0, 1, 2.0)
    assert found.half_width(0.5) == pytest.approx(0.98)
    nothing = spread_between(np.zeros(3), np.full(3, np.inf), 9)
    assert (nothing.std, nothing.p, nothing.sessions) == (0.0, 1.0, 0)


def test_intervals_of_few_sessions_are_wide() -> None:
    three = Spread(mean=1.0, std=0.3, p=0.0, error=0.3 / np.sqrt(3), sessions=3)
    width = stats.t.ppf(0.975, 2) * np.hypot(0.01, 0.3 / np.sqrt(3))
    assert three.half_width(0.01) == pytest.approx(width)


# Balances of several days


@functools.cache
def moving(seconds: float) -> Motion:
    with TemporaryDirectory() as folder:
        return moved(Path(folder), 2, seconds=seconds, tau_cmd=None, q_des=None, dq_des=None)


def days(
    levels: Sequence[float],
    sessions: Sequence[str] | None = None,
    *,
    noise: float = 0.05,
    seed: int = 7,
    seconds: float = 20.0,
) -> Balances:
    """Recordings of an arm whose second joint has these coefficients of viscous friction."""
    motion = moving(seconds)
    motions = []
    for k, level in enumerate(levels):
        rng = np.random.default_rng([seed, k])
        torque = motion.tau + noise * rng.standard_normal(motion.tau.shape)
        torque[:, 1] += level * motion.dq[:, 1]
        named = replace(motion.recording, name=f"run{k}")
        setup = Setup(session=f"day {k}" if sessions is None else sessions[k])
        motions.append(replace(motion, recording=named, torque=torque, setup=setup, cache={}))
    return Balances(motions)


def learnt(b: Balances) -> Estimate:
    return figure(ordinary_fit(b), "viscous_friction", 1)


def test_sessions_are_those_that_the_study_tells_of() -> None:
    setups = [Setup(session=each) for each in ("mon", "", "mon", "tue", "")]
    told = given_sessions(setups)
    assert told is not None
    assert told.tolist() == [0, 1, 0, 2, 1]  # those not told are one
    assert given_sessions([Setup(), Setup()]) is None
    assert given_sessions([Setup(session="mon"), Setup(session="mon")]) is None


def test_spread_and_mean_are_those_of_the_days() -> None:
    rng = np.random.default_rng(3)
    inside, spreads, said = [], [], []
    for seed in range(20):
        found = learnt(days(1.0 + 0.15 * rng.standard_normal(4), seed=seed, seconds=7.0))
        assert found.spread is not None
        assert found.spread_p is not None
        inside.append(found.interval95[0] <= 1.0 <= found.interval95[1])
        spreads.append(found.spread)
        said.append(found.spread_p < 0.01)
    assert np.mean(inside) > 0.87
    assert np.sqrt(np.mean(np.square(spreads))) == pytest.approx(0.15, rel=0.25)
    assert np.mean(said) > 0.95


def test_of_days_that_are_alike_no_change_is_said() -> None:
    found = [learnt(days([1.0] * 4, seed=seed, seconds=7.0)) for seed in range(30)]
    assert np.mean([each.spread_p < 0.01 for each in found]) < 0.1
    assert np.median([each.spread for each in found]) < 0.003
    inside = [each.interval95[0] <= 1.0 <= each.interval95[1] for each in found]
    assert np.mean(inside) > 0.87
    widths = [each.interval95[1] - each.interval95[0] for each in found]
    alone = learnt(days([1.0] * 4, [""] * 4, seconds=7.0))
    assert alone.spread is alone.spread_p is None
    assert np.median(widths) < 3.0 * (alone.interval95[1] - alone.interval95[0])


def test_a_session_that_does_not_show_a_term_says_nothing_of_it() -> None:
    b = days([0.9, 1.1, 1.0, 2.0])
    resting = slice(int(b.starts[3]), int(b.starts[4]))
    b.mask["torque", 1][resting] = False  # as where a joint does not move
    found = learnt(b)
    assert found.spread == pytest.approx(0.1, rel=0.1)
    assert found.value == pytest.approx(1.0, abs=0.02)
    for k in range(3):
        b.mask["torque", 1][int(b.starts[k]) : int(b.starts[k + 1])] = k == 0
    alone = learnt(b)
    assert alone.spread is alone.spread_p is None
    assert alone.value == pytest.approx(0.9, abs=0.02)


def test_recordings_of_one_day_are_one() -> None:
    by_two = learnt(days([0.9, 0.9, 1.1, 1.1], ["a", "a", "b", "b"]))
    assert by_two.spread == pytest.approx(np.sqrt(0.02), rel=0.05)
    by_four = learnt(days([0.9, 0.9, 1.1, 1.1], ["a", "b", "c", "d"]))
    assert by_four.spread == pytest.approx(0.2 / np.sqrt(3), rel=0.05)
    two, four = (e.interval95[1] - e.interval95[0] for e in (by_two, by_four))
    assert two == pytest.approx(2 * stats.t.ppf(0.975, 1) * 0.1, rel=0.05)
    assert four == pytest.approx(2 * stats.t.ppf(0.975, 3) * 0.2 / np.sqrt(12), rel=0.05)


def test_what_differs_within_a_day_is_no_change_of_days() -> None:
    levels = [0.8, 1.2, 0.85, 1.15]  # of motions, or by chance, but not of days
    within = learnt(days(levels, ["a", "a", "b", "b"]))
    assert within.spread == 0.0
    assert within.spread_p is not None
    assert within.spread_p > 0.3
    each = learnt(days(levels, ["a", "b", "c", "d"]))
    assert each.spread == pytest.approx(np.std(levels, ddof=1), rel=0.05)
    clear = learnt(days([0.99, 1.01, 1.99, 2.01], ["a", "a", "b", "b"]))
    assert clear.spread == pytest.approx(np.sqrt(0.5), rel=0.05)
    assert clear.spread_p is not None
    assert clear.spread_p < 0.01


@pytest.mark.parametrize("levels", [[0.8, 1.0, 1.2], [0.4, 1.0, 1.6], [1.0, 1.0, 1.0]])
def test_whatever_days_differ_by_friction_alone_is_named(levels: list[float]) -> None:
    state = identified(days(levels))
    assert named(state) == {("viscous_friction", (1,))}
    found = figure(state.fit, "viscous_friction", 1)
    assert found.interval95[0] < 1.0 < found.interval95[1]


# Diagnoses

COULOMB, VISCOUS = np.array([1.5, 2.0, 1.0]), np.array([0.8, 1.0, 0.5])
FRICTION = {"coulomb_friction", "viscous_friction"}


def rubbing(of_coulomb: Any, of_viscous: Any, session: str, role: str = "fit") -> Run:
    """Friction by so many times the usual, of all joints or of each."""
    return Run(
        coulomb=tuple((COULOMB * of_coulomb).tolist()),
        viscous=tuple((VISCOUS * of_viscous).tolist()),
        role=role,
        told={"session": session} if session else {},
    )


def two_days(session: bool = True) -> list[Run]:
    a, b, c = ("a", "b", "c") if session else ("", "", "")
    runs = [rubbing(k, k, name) for k, name in ((0.9, a), (0.9, a), (1.1, b), (1.1, b))]
    return [*runs, rubbing(1.0, 1.0, c, "validate")]


def test_friction_that_differs_between_two_days_is_named_as_nothing_else(tmp_path: Path) -> None:
    found = diagnose(write_days(tmp_path, two_days(), seconds=16.0))
    assert {each.effect for each in found.findings} == FRICTION
    assert found.suspected == ()
    assert len(found.findings) == 6
    assert found.verdict == "mismatch_explained"
    assert any("Figures are means over sessions" in note for note in found.notes)
    assert any("a: run0.csv, run1.csv; b: run2.csv, run3.csv" in note for note in found.notes)
    for each in found.findings:
        estimate = next(iter(each.parameters.values()))
        true = (COULOMB if each.effect == "coulomb_friction" else VISCOUS)[
            int(each.joints[0][1]) - 1
        ]
        assert estimate.value == pytest.approx(true, rel=0.01)
        assert estimate.spread == pytest.approx(true * np.sqrt(0.02), rel=0.05)
        assert estimate.interval95[0] == 0.0  # no friction drives, however few the sessions
        assert estimate.interval95[1] > 2.0 * true


@pytest.fixture(scope="module")
def four_days(tmp_path_factory: pytest.TempPathFactory) -> tuple[Diagnosis, np.ndarray, np.ndarray]:
    """A diagnosis, and what friction was drawn for each day and joint, (4, 3) each."""
    rng = np.random.default_rng(5)
    coulomb, viscous_ = 1.0 + 0.15 * rng.standard_normal((2, 4, 3))
    runs = [rubbing(coulomb[k], viscous_[k], f"day {k}") for k in range(4)]
    runs.append(rubbing(1.1, 0.9, "another", "validate"))
    path = write_days(tmp_path_factory.mktemp("days"), runs, seconds=16.0)
    return diagnose(path), COULOMB * coulomb, VISCOUS * viscous_


def test_friction_drawn_for_each_day_is_found_with_its_spread(
    four_days: tuple[Diagnosis, np.ndarray, np.ndarray],
) -> None:
    found, coulomb, viscous_ = four_days
    assert {each.effect for each in found.findings} == FRICTION
    assert len(found.findings) == 6
    assert found.verdict == "mismatch_explained"
    inside = []
    for each in found.findings:
        j = int(each.joints[0][1]) - 1
        drawn = (coulomb if each.effect == "coulomb_friction" else viscous_)[:, j]
        true = (COULOMB if each.effect == "coulomb_friction" else VISCOUS)[j]
        estimate = next(iter(each.parameters.values()))
        assert estimate.value == pytest.approx(drawn.mean(), rel=0.02)
        assert estimate.spread == pytest.approx(drawn.std(ddof=1), rel=0.05, abs=0.003)
        assert each.support is not None
        assert each.support.sessions == 4
        inside.append(estimate.interval95[0] <= true <= estimate.interval95[1])
    assert sum(inside) >= 5


def test_the_change_is_said_where_it_is_clear(
    four_days: tuple[Diagnosis, np.ndarray, np.ndarray],
) -> None:
    found, coulomb, _ = four_days
    said = changes_words(found)
    assert len(said) == 2
    rub = next(each for each in said if "Coulomb" in each)
    for j in range(3):
        share = 100.0 * coulomb[:, j].std(ddof=1) / coulomb[:, j].mean()
        percents = rub.partition(f"j{j + 1} by ")[2].partition(" %")[0]
        assert float(percents) == pytest.approx(share, rel=0.06, abs=0.6)
    with out.capture() as captured:
        print_diagnosis(found)
    assert rub.split(" changes")[0] in captured.get()
    quiet = replace(
        found,
        findings=tuple(
            replace(f, parameters={n: replace(e, spread_p=0.5) for n, e in f.parameters.items()})
            for f in found.findings
        ),
    )
    assert changes_words(quiet) == []
    assert all(joint_state(fit) == "explained" for fit in found.joints.values())
    assert any(
        joint_state(replace(fit, spread=0.0)) != "explained" for fit in found.joints.values()
    )


def test_spreads_are_in_the_file_and_old_files_are_read(
    four_days: tuple[Diagnosis, np.ndarray, np.ndarray],
) -> None:
    found, _, _ = four_days
    assert Diagnosis.from_json(found.to_json()) == found
    content = json.loads(found.to_json())
    for finding in content["findings"]:
        for estimate in finding["parameters"].values():
            assert estimate.pop("spread") > 0.0
            assert estimate.pop("spread_p") < 0.01
    for joint in content["joints"].values():
        assert joint.pop("spread") > 0.0
    old = Diagnosis.from_json(json.dumps(content))
    assert all(e.spread is None for f in old.findings for e in f.parameters.values())
    assert [f.values for f in old.findings] == [f.values for f in found.findings]


def test_friction_that_warms_up_in_every_recording_is_found_beside_days(tmp_path: Path) -> None:
    runs = [replace(each, warm=(0.0, 1.5, 0.0)) for each in two_days()]
    found = diagnose(write_days(tmp_path, runs, seconds=16.0))
    drifts = [each for each in found.findings if each.effect == "friction_drift"]
    assert [each.joints for each in drifts] == [("j2",)]
    assert {each.effect for each in found.findings} == FRICTION | {"friction_drift"}


def test_sessions_are_told_of_without_a_robot_too(tmp_path: Path) -> None:
    runs = [rubbing(1.0, 1.0, name) for name in ("a", "b", "c")]
    path = write_days(tmp_path, [*runs, rubbing(1.0, 1.0, "d", "validate")], seconds=8.0)
    content = yaml.safe_load(path.read_text())
    del content["robot"], content["tip"]
    path.write_text(yaml.safe_dump(content))
    found = diagnose(path)
    assert found.findings == ()
    assert any("a: run0.csv; b: run1.csv; c: run2.csv" in note for note in found.notes)


def test_intervals_over_sessions_end_at_what_a_figure_may_be() -> None:
    rough = Estimate(value=1.0, std=0.5, interval95=(-1.0, 3.0), unit="N m", spread=0.2)
    level = within_bounds(CATALOGUE["coulomb_friction"], {"level": rough})["level"]
    assert level.interval95 == (0.0, 3.0)
    alone = replace(rough, spread=None)
    kept = within_bounds(CATALOGUE["coulomb_friction"], {"level": alone})["level"]
    assert kept is alone
    assert Finding(effect="coulomb_friction", parameters={"level": level}).values == {"level": 1.0}
