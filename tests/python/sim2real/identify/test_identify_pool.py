"""What candidates are worth beside a model, against dense algebra; what is believed of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import signal

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify import (
    Hypothesis,
    Linearisation,
    Model,
    Pool,
    anomalous,
    count_independent,
    ordinary,
)
from pdoik.sim2real.motion import Balances, Gate, Motion, Place
from pdoik.sim2real.regression import Term, term_of
from sim2real_evidence_rows import TORQUES, add, believed, data_of, log_likelihood, term, weights
from sim2real_motions import moved


def beside(rng: np.random.Generator) -> tuple[Model, list[Hypothesis]]:
    """A model, one of whose coefficients rests on its bound, and candidates of every width."""
    data = data_of(rng)
    rubs = term(rng, 2, TORQUES[:1])
    known = [
        believed(rng, term(rng, 3)),
        believed(rng, rubs, size=0.5, positive=True),
        believed(rng, term(rng, 1, TORQUES[2:]), mean=1.0),
    ]
    add(data, rubs, [0.5 / np.sqrt(known[1].precision[0]), -0.5 / np.sqrt(known[1].precision[1])])
    among = [
        believed(rng, term(rng, 1), log_odds=-3.0),
        believed(rng, term(rng, 2, TORQUES[:2]), log_odds=-1.0),
        believed(rng, term(rng, 10), log_odds=-4.0),
        believed(rng, term(rng, 10, TORQUES[1:]), mean=0.7),
        believed(rng, term(rng, 1, TORQUES[2:]), mean=-1.0, log_odds=-2.0),
    ]
    add(data, among[2].term, 1.0 / np.sqrt(among[2].precision))
    data.series["torque", 0].independent /= 5.0
    return Model(data, known), among


def worth(model: Model, candidate: Hypothesis) -> float:
    """Log odds at the model's noise, what rests on its bound left there."""
    own = []
    for each, span in model.placed:
        at = model.active[span]
        columns = {key: column[:, at] for key, column in each.term.columns.items()}
        kept = replace(each.term, columns=columns, prior=each.term.prior[at])
        own.append(replace(each, term=kept, mean=each.mean[at], precision=each.precision[at]))
    noise = weights(model)
    before = log_likelihood(model.data, own, noise)
    return log_likelihood(model.data, [*own, candidate], noise) - before + candidate.log_odds


@pytest.mark.parametrize("seed", range(4))
def test_candidates_are_worth_what_densities_of_all_rows_say(seed: int) -> None:
    model, among = beside(np.random.default_rng(seed))
    assert not model.active.all()
    scored = Pool(model.data, among).scored(model)
    assert len(scored) == len(among)
    for each in scored:
        assert each.log_odds == pytest.approx(worth(model, each.hypothesis), rel=1e-5, abs=1e-5)
    odds = [each.log_odds for each in scored]
    assert odds == sorted(odds, reverse=True)
    assert odds[0] > 5.0 > -1.0 > odds[-1]
    (alone,) = Pool(model.data, among[3:4]).scored(Model(model.data, (), model))
    bare = Model(model.data, (), model)
    assert alone.log_odds == pytest.approx(worth(bare, among[3]), rel=1e-5, abs=1e-5)


def test_a_pool_goes_on_beside_models_that_came_later() -> None:
    rng = np.random.default_rng(0)
    model, among = beside(rng)
    pool = Pool(model.data, among)
    pool.scored(model)
    grown = model
    for k in range(3):  # wider than the room that the series have at first
        more = believed(rng, term(rng, 30, TORQUES if k else TORQUES[1:]))
        grown = grown.with_(more, among[k])
        now = {each.hypothesis: each.log_odds for each in pool.scored(grown)}
        fresh = {each.hypothesis: each.log_odds for each in Pool(model.data, among).scored(grown)}
        assert now == pytest.approx(fresh, rel=1e-9)
        assert now[among[4]] == pytest.approx(worth(grown, among[4]), rel=1e-4, abs=1e-4)
        assert now[among[k]] < 3.0  # it is there already
    again = {each.hypothesis: each.log_odds for each in pool.scored(model)}
    first = {each.hypothesis: each.log_odds for each in Pool(model.data, among).scored(model)}
    assert again == pytest.approx(first, rel=1e-9)


def test_what_changes_no_row_that_counts_is_no_candidate() -> None:
    rng = np.random.default_rng(1)
    model, among = beside(rng)
    key = TORQUES[0]
    hidden = term(rng, 2, [key])
    hidden.columns[key][model.data.series[key].rows] = 0.0
    elsewhere = term(rng, 1, [("tip", 3)])
    found = Pool(model.data, [believed(rng, hidden), among[1], believed(rng, elsewhere)])
    assert found.candidates == [among[1]]
    assert [each.hypothesis for each in found.scored(model)] == [among[1]]
    assert Pool(model.data, []).scored(model) == []


@pytest.mark.parametrize("size", [-2.0, 2.0])
def test_what_cannot_be_is_left_out(size: float) -> None:
    rng = np.random.default_rng(2)
    data = data_of(rng, keys=TORQUES[:1])
    falls = believed(rng, term(rng, 1, TORQUES[:1], effect="friction_drift"), size=1.0)
    add(data, falls.term, size / np.sqrt(falls.precision))
    found = [each.hypothesis for each in Pool(data, [falls]).scored(Model(data, []))]
    assert found == ([falls] if size > 0.0 else [])


def test_what_another_shape_may_make_possible_is_not_left_out() -> None:
    """A delay whose column is wanted four times is another delay; this one cannot be."""
    rng = np.random.default_rng(3)
    data = data_of(rng, keys=TORQUES[:1])
    late = term(rng, 1, TORQUES[:1], effect="command_delay")
    hypothesis = Hypothesis(term=late, mean=np.ones(1), precision=np.full(1, 0.15**-2))
    late.columns[TORQUES[0]] *= 20.0 / np.std(late.columns[TORQUES[0]])
    add(data, late, [4.0])
    (found,) = Pool(data, [hypothesis]).scored(Model(data, []))
    assert found.hypothesis is hypothesis
    assert Model(data, [hypothesis]).impossible == [hypothesis]


@pytest.mark.parametrize("seed", range(3))
def test_what_rows_want_negative_and_cannot_be_is_worth_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    data = data_of(rng, keys=TORQUES[:1])
    rubs = believed(rng, term(rng, 1, TORQUES[:1]), size=1.0, positive=True, ordinary=True)
    add(data, rubs.term, -2.0 / np.sqrt(rubs.precision))
    bare = Model(data, [])
    assert bare.with_(rubs).beta == [0.0]
    assert all(each.log_odds < 1e-6 for each in Pool(data, [rubs]).scored(bare))


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Motion:
    folder = tmp_path_factory.mktemp("arm")
    return moved(folder, 2, tau_cmd=None, q_des=None, dq_des=None, seconds=40.0)


def left(arm: Motion, what: Any, noise: float = 0.05) -> Balances:
    """The arm with a torque more at its second joint."""
    assert arm.torque is not None
    torque = arm.tau + noise * np.random.default_rng(0).standard_normal(arm.tau.shape)
    torque[:, 1] += what
    return Balances([replace(arm, torque=torque, cache={})])


def made(b: Balances, effect: str, place: Place, shape: tuple[float, ...] = ()) -> Term:
    found = term_of(b, CATALOGUE[effect], place, shape)
    assert found is not None
    return found


def test_a_cause_is_as_large_as_a_share_of_what_its_joint_bears(arm: Motion) -> None:
    b = left(arm, 2.0 * np.sign(arm.dq[:, 1]))
    believed_of, key = b.thresholds.priors, ("torque", 1)
    place = Place(joints=(1,))
    usual = np.hypot(np.sqrt(np.mean(arm.borne[:, 1] ** 2)), b.rms(key))
    late = replace(place, gate=Gate(of="time", low=25.0, high=35.0))
    spring = made(b, "position_dependent_spring", place, (1.0, 0.5))
    for each in (spring, made(b, "viscous_friction", place), made(b, "viscous_friction", late)):
        hypothesis = anomalous(b, each)
        column = each.columns[key][b.mask[key], 0]
        acting = column[column != 0.0]
        part = np.sqrt(np.mean(acting**2) / hypothesis.precision[0])
        assert part == pytest.approx(believed_of.usual_part * usual, rel=1e-6)
        assert hypothesis.mean == [0.0]
        assert np.array_equal(hypothesis.term.prior, hypothesis.precision)
    assert np.mean(late.gate.weight(b.time)) < 0.3  # type: ignore[union-attr]


def test_odds_are_shared_by_all_that_was_looked_at(arm: Motion) -> None:
    b, place = left(arm, 0.0), Place(joints=(0,))
    rubs = made(b, "viscous_friction", place)
    odds = CATALOGUE["viscous_friction"].odds
    assert anomalous(b, rubs).log_odds == pytest.approx(np.log(odds / (1.0 - odds)))
    assert anomalous(b, rubs).log_odds - anomalous(b, rubs, among=40.0).log_odds == pytest.approx(
        np.log(40.0)
    )
    effect = CATALOGUE["unknown"]
    by_code = {shape[0]: shape for shape in effect.shapes(b.motions, place)}
    one, two = (anomalous(b, made(b, "unknown", place, by_code[code])) for code in (0.0, 4.0))
    assert two.log_odds - one.log_odds == effect.log_prior(by_code[4.0]) < -1.0
    assert ordinary(rubs, 2.0).log_odds == 0.0


def test_bodies_are_believed_by_their_links_and_tilts_by_what_bases_have(arm: Motion) -> None:
    b = left(arm, 0.0)
    for effect in ("payload", "link_inertial_error"):
        body = made(b, effect, Place(link=1))
        assert (body.prior > 0.0).all()
        assert np.array_equal(anomalous(b, body).precision, body.prior)
    level, any_way = (made(b, "gravity_direction", Place(), shape) for shape in ((), (1.0,)))
    assert anomalous(b, any_way).precision == pytest.approx(np.ones(3))
    assert (anomalous(b, level).precision > 50.0).all()


def test_what_is_one_by_meaning_is_believed_to_be_one(tmp_path: Path) -> None:
    b = Balances([moved(tmp_path, 2)])
    place = Place(joints=(1,))
    shape = CATALOGUE["command_delay"].shapes(b.motions, place)[0]
    late = made(b, "command_delay", place, shape)
    hypothesis = anomalous(b, late)
    assert hypothesis.mean == [1.0]
    assert hypothesis.precision == pytest.approx(b.thresholds.priors.fixed_error**-2)
    assert hypothesis.term is late


def test_rows_are_counted_where_all_that_has_a_cause_is_explained(arm: Motion) -> None:
    """Not where a slow sweep of what nobody named yet looks like a few rows."""
    rng = np.random.default_rng(1)
    wanders = signal.lfilter([1.0], [1.0, -0.985], rng.standard_normal(len(arm.time)))
    causes = {
        "position": 3.0 * np.sin(2.5 * arm.q[:, 1]),
        "friction": 3.0 * np.tanh(arm.dq[:, 1] / 0.05) + arm.dq[:, 1],
        "nothing": 0.4 * wanders,
    }
    share, before = {}, {}
    for name, cause in causes.items():
        b = left(arm, cause, noise=0.3)
        data = Linearisation.of_balances(b)
        series = data.series["torque", 1]
        before[name] = 1.0 / series.repeats(series.target)
        count_independent(b, data)
        share[name] = series.independent / len(series.rows)
    least = 1.0 / b.thresholds.priors.least_repeats
    assert max(before.values()) < 0.15
    for name in ("position", "friction"):
        assert 0.6 * least < share[name] <= least
    assert share["nothing"] < 0.3 * least
