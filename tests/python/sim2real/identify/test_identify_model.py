"""Models of the posterior, against dense linear algebra by NumPy and SciPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.identify import Hypothesis, Linearisation, Model, Series, ordinary
from pdoik.sim2real.motion import Place
from sim2real_evidence_rows import (
    STUDY,
    TORQUES,
    add,
    believed,
    data_of,
    log_likelihood,
    priors,
    stacked,
    term,
    weights,
)


def mixed(rng: np.random.Generator, times: float = 1.0) -> tuple[Linearisation, list[Hypothesis]]:
    """Balances that several hypotheses share, some of them there, with means and without."""
    data = data_of(rng)
    hypotheses = [
        believed(rng, term(rng, 3)),
        believed(rng, term(rng, 1, TORQUES[:1]), mean=1.0),
        believed(rng, term(rng, 10, TORQUES[1:]), mean=-0.5),
        believed(rng, term(rng, 1, TORQUES[2:])),
    ]
    for each in hypotheses[:3]:
        away = times * rng.standard_normal(each.width) / np.sqrt(each.precision)
        add(data, each.term, each.mean + away)
    return data, hypotheses


@pytest.mark.parametrize("seed", range(4))
def test_coefficients_and_covariance_are_those_of_dense_ridge_regression(seed: int) -> None:
    data, hypotheses = mixed(np.random.default_rng(seed))
    data.series["torque", 1].independent /= 7.0
    model = Model(data, hypotheses)
    design, target = stacked(data, hypotheses, weights(model))
    mean, precision = priors(hypotheses)
    root = np.sqrt(precision)
    augmented = np.vstack([design / root, np.eye(len(root))])  # of coefficients in their sizes
    expected = np.linalg.lstsq(augmented, np.concatenate([target, root * mean]))[0] / root
    assert model.beta * root == pytest.approx(expected * root, rel=1e-6, abs=1e-8)
    covariance = np.linalg.inv(augmented.T @ augmented) / np.outer(root, root)
    np.testing.assert_allclose(
        model.inverse * np.outer(root, root), covariance * np.outer(root, root), atol=1e-7
    )
    assert model.variances == pytest.approx(np.diag(covariance), rel=1e-5)
    for key, series in data.series.items():
        parts = [model.part(h).get(key, 0.0) for h in hypotheses]
        np.testing.assert_allclose(sum(parts) + model.left(key), series.target, atol=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_coefficients_that_must_be_positive_are_those_of_scipys_bounded_least_squares(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    data = data_of(rng)
    hypotheses = [believed(rng, term(rng, 6), positive=True), believed(rng, term(rng, 2))]
    add(data, hypotheses[0].term, rng.standard_normal(6) / np.sqrt(hypotheses[0].precision))
    model = Model(data, hypotheses)
    design, target = stacked(data, hypotheses, weights(model))
    root = np.sqrt(priors(hypotheses)[1])
    augmented = np.vstack([design / root, np.eye(8)])
    low = np.where(np.arange(8) < 6, 0.0, -np.inf)
    right = np.concatenate([target, np.zeros(8)])
    expected = optimize.lsq_linear(augmented, right, (low, np.inf), tol=1e-14).x
    assert model.beta * root == pytest.approx(expected, abs=1e-4)
    assert (model.beta[:6] >= 0.0).all()
    assert 0 < np.count_nonzero(model.beta[:6] == 0.0) == np.count_nonzero(~model.active) < 6
    assert (model.variances[~model.active] == 0.0).all()


@pytest.mark.parametrize("seed", [0, 1, 230, 354, 476])
def test_what_rests_on_its_bound_is_pushed_against_it(seed: int) -> None:
    """Also where columns lean on one another so much that one falls out for another's sake."""
    rng = np.random.default_rng(seed)
    data, mixing = data_of(rng), rng.standard_normal((4, 4))
    made = term(rng, 4)
    leaning = {key: rng.standard_normal((STUDY, 4)) @ mixing for key in made.columns}
    hypothesis = believed(rng, replace(made, columns=leaning), size=1.0, positive=True)
    add(data, hypothesis.term, rng.standard_normal(4))
    model = Model(data, [hypothesis])
    design, target = stacked(data, [hypothesis], weights(model))
    slope = design.T @ (target - design @ model.beta) - hypothesis.precision * model.beta
    slope /= np.sqrt(np.sum(design**2, axis=0) + hypothesis.precision)  # in standard errors
    assert slope[model.active] == pytest.approx(0.0, abs=1e-4)
    assert slope[~model.active].max() < 1e-4


@pytest.mark.parametrize("seed", range(3))
def test_a_model_is_the_same_without_what_rests_on_its_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    data, hypotheses = mixed(rng)
    rubs = believed(rng, term(rng, 1), size=1.0, positive=True)
    add(data, rubs.term, -2.0 / np.sqrt(rubs.precision))
    with_it, without = Model(data, [*hypotheses, rubs]), Model(data, hypotheses)
    assert not with_it.active[-1]
    assert with_it.beta[:-1] == pytest.approx(without.beta, rel=1e-4)
    assert with_it.log_evidence == pytest.approx(without.log_evidence, abs=1e-4)
    assert with_it.noise == pytest.approx(without.noise, rel=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_evidence_is_that_of_one_normal_density_of_all_rows(seed: int) -> None:
    """At noise that is held: no model leaves as much as the floors."""
    data, hypotheses = mixed(np.random.default_rng(seed))
    for series in data.series.values():
        series.floor = 2.0 * float(np.sqrt(series.square / len(series.rows)))
    among = [[], hypotheses[:1], hypotheses[1:], hypotheses]
    models = [Model(data, each) for each in among]
    exact = [log_likelihood(data, each, weights(m)) for m, each in zip(models, among, strict=True)]
    for model in models:
        assert model.noise == {key: each.floor**2 for key, each in data.series.items()}
    found = [model.log_evidence for model in models]
    assert np.ptp(exact) > 1.0
    assert np.diff(found) == pytest.approx(np.diff(exact), rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("times", [1.0, 10.0])
@pytest.mark.parametrize("seed", [0, 3, 5])
def test_noise_is_where_the_exact_evidence_is_largest(seed: int, times: float) -> None:
    """Whether causes are as large as is usual or ten times that, and wherever it began."""
    data, hypotheses = mixed(np.random.default_rng(seed), times)
    model = Model(data, hypotheses)

    def lost(logs: np.ndarray) -> float:
        each = dict(zip(data.series, np.exp(-logs), strict=True))
        return -log_likelihood(data, hypotheses, each)

    at = np.log(list(model.noise.values()))
    best = optimize.minimize(lost, at, method="Nelder-Mead", options={"xatol": 1e-3})
    assert at == pytest.approx(best.x, abs=0.05)
    assert lost(at) == pytest.approx(best.fun, abs=0.2)
    for like in (Model(data, []), Model(data, hypotheses[1:]), model):
        other = Model(data, hypotheses, like)
        assert other.log_evidence == pytest.approx(model.log_evidence, abs=0.2)
        assert other.noise == pytest.approx(model.noise, rel=0.05)


def test_noise_is_never_below_its_floor() -> None:
    rng = np.random.default_rng(1)
    data = data_of(rng, floor=[1e-6, 3.0, 0.7])
    whole = believed(rng, term(rng, 2), size=3.0)
    add(data, whole.term, 1.0 / np.sqrt(whole.precision))
    bare, explained = Model(data, []), Model(data, [whole])
    for key, series in data.series.items():
        assert bare.noise[key] == pytest.approx(series.square / len(series.rows))
        assert series.floor**2 <= explained.noise[key] < 0.6 * bare.noise[key]
    assert explained.noise["torque", 1] == 9.0
    assert explained.noise["torque", 0] < 0.5


@pytest.mark.parametrize("times", [2, 9])
def test_rows_that_are_written_several_times_and_counted_once_say_the_same(times: int) -> None:
    data, hypotheses = mixed(np.random.default_rng(5))
    again = {}
    for key, each in data.series.items():
        rows = np.repeat(each.rows, times)
        target = np.repeat(each.target, times)
        again[key] = replace(each, rows=rows, target=target, independent=float(len(each.rows)))
    once, more = Model(data, hypotheses), Model(Linearisation(again), hypotheses)
    assert more.beta == pytest.approx(once.beta, rel=1e-6)
    assert more.noise == pytest.approx(once.noise, rel=1e-6)
    assert more.variances == pytest.approx(once.variances, rel=1e-6)
    assert more.log_evidence == pytest.approx(once.log_evidence, rel=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_only_what_is_in_a_model_counts_and_neither_its_order_nor_other_balances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    data, hypotheses = mixed(rng)
    model = Model(data, hypotheses)
    turned = Model(data, hypotheses[::-1])
    grown = Model(data, hypotheses[:1]).with_(*hypotheses[1:])
    fewer = Model(data, [*hypotheses, believed(rng, term(rng, 4))])
    for other in (turned, grown, fewer.without(fewer.hypotheses[-1])):
        assert other.log_evidence == pytest.approx(model.log_evidence, abs=0.05)
        assert other.noise == pytest.approx(model.noise, rel=0.02)
    assert turned.beta[-3:] == pytest.approx(model.beta[:3], rel=1e-6)
    rows = np.arange(STUDY)
    own = Series(rows=rows, target=rng.standard_normal(STUDY), floor=0.1, parts=(slice(0, STUDY),))
    beside = Linearisation({**data.series, ("drive", 0): own})
    gained = [
        Model(each, hypotheses).log_evidence - Model(each, hypotheses[:1]).log_evidence
        for each in (data, beside)
    ]
    assert gained[1] == pytest.approx(gained[0], rel=1e-9)
    assert abs(gained[0]) > 1.0


@pytest.mark.parametrize(
    ("true", "possible"), [(0.4, False), (0.8, True), (1.4, True), (1.9, False)]
)
def test_a_coefficient_that_is_one_by_meaning_is_held_near_one(true: float, possible: bool) -> None:
    rng = np.random.default_rng(3)
    data = data_of(rng, keys=TORQUES[:1])
    late = term(rng, 1, TORQUES[:1], effect="command_delay")
    loud = replace(late, columns={k: 30.0 * c / np.std(c) for k, c in late.columns.items()})
    add(data, loud, [true])
    hypothesis = Hypothesis(term=loud, mean=np.ones(1), precision=np.full(1, 0.15**-2))
    model = Model(data, [hypothesis])
    assert model.beta[0] == pytest.approx(true, abs=0.01)
    assert (model.impossible == []) == model.admissible == possible
    assert np.isfinite(model.log_posterior) == possible
    faint = replace(loud, columns={k: 1e-6 * c for k, c in loud.columns.items()})
    unknown = replace(hypothesis, term=faint, log_odds=-4.0)
    guess = Model(data, [unknown])
    assert guess.beta[0] == pytest.approx(1.0, abs=1e-4)  # where rows say nothing, its mean
    assert guess.log_posterior == guess.log_evidence - 4.0


@pytest.mark.parametrize(("size", "where", "possible"), [
    (1.5, 0, True), (1.9, 0, True), (2.2, 0, False), (-0.5, 0, False), (0.5, 1, False),
])  # fmt: skip
def test_friction_falls_by_no_more_than_twice_what_stays(
    size: float, where: int, possible: bool
) -> None:
    rng = np.random.default_rng(4)
    data = data_of(rng, keys=TORQUES[:1])
    made = {
        name: term(rng, 1, TORQUES[:1], effect=name, place=Place(joints=(j,)))
        for name, j in (("coulomb_friction", where), ("friction_drift", 0))
    }
    even = {
        name: replace(each, columns={k: 10.0 * c / np.std(c) for k, c in each.columns.items()})
        for name, each in made.items()
    }
    stays, falls = even["coulomb_friction"], even["friction_drift"]
    add(data, stays, [3.0])
    add(data, falls, [3.0 * size])
    cause = Hypothesis(term=falls, mean=np.zeros(1), precision=np.full(1, 1e-3))
    model = Model(data, [ordinary(stays, 10.0, positive=True), cause])
    assert model.beta == pytest.approx([3.0, 3.0 * size], abs=0.1)
    assert model.impossible == ([] if possible else [cause])
    assert Model(data, [ordinary(stays, 10.0), replace(cause, ordinary=True)]).admissible


def test_friction_may_fall_beside_a_finer_law_of_what_stays() -> None:
    """Presliding stands in the place of Coulomb friction, and is what warms up."""
    rng = np.random.default_rng(5)
    data, place = data_of(rng, keys=TORQUES[:1]), Place(joints=(0,))
    stays, falls = (
        believed(rng, term(rng, 1, TORQUES[:1], effect=name, place=place), size=1.0)
        for name in ("presliding_hysteresis", "friction_drift")
    )
    for each in (stays, falls):
        add(data, each.term, 3.0 / np.sqrt(each.precision))
    assert Model(data, [stays, falls]).impossible == []
    assert Model(data, [falls]).impossible == [falls]
