"""Evidence and coefficients of models against SciPy, and what intervals are worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize, stats

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.identify.figures import estimates
from pdoik.sim2real.identify.hypothesis import Hypothesis, peculiar
from pdoik.sim2real.identify.linearisation import Linearisation, Series
from pdoik.sim2real.identify.model import Model
from pdoik.sim2real.identify.pool import Pool
from pdoik.sim2real.identify.posterior import Posterior
from pdoik.sim2real.motion.balances import Balances
from pdoik.sim2real.motion.place import Key, Place
from pdoik.sim2real.regression.fit import Term, term_of
from sim2real_identified import BODIES
from sim2real_motions import moved

KEYS: tuple[Key, ...] = (("torque", 0), ("torque", 1))
COUNT = 200
LOUD = 3.0  # a floor above all that is left: the noise is this, whatever the model


def data(seed: int, floor: float = LOUD) -> Linearisation:
    rng = np.random.default_rng(seed)
    return Linearisation(
        {
            key: Series(
                rows=np.arange(COUNT),
                target=rng.standard_normal(COUNT),
                floor=floor,
                parts=(slice(0, COUNT),),
            )
            for key in KEYS
        }
    )


def hypothesis(
    seed: int, width: int, keys: Sequence[Key] = KEYS, *, positive: bool = False
) -> Hypothesis:
    """Of an effect that may be anything; its columns differ by many powers of ten."""
    rng = np.random.default_rng(1000 + seed)
    scale = 10.0 ** rng.uniform(-3, 3, width)
    term = Term(
        effect="torque_offset",
        place=Place(joints=(seed,)),
        shape=(),
        columns={key: scale * rng.standard_normal((COUNT, width)) for key in keys},
        prior=np.ones(width),
    )
    return Hypothesis(
        term=term,
        mean=rng.standard_normal(width) / scale,
        precision=scale**2 * rng.uniform(0.5, 2.0, width),
        log_odds=-2.0,
        ordinary=positive,
        positive=positive,
    )


def stacked(rows: Linearisation, among: Sequence[Hypothesis]) -> tuple[np.ndarray, np.ndarray]:
    """Columns and targets of all rows, in sigmas."""
    none = [np.zeros((COUNT, each.width)) for each in among]
    columns = [
        np.hstack([e.term.columns.get(key, z) for e, z in zip(among, none, strict=True)])
        for key in KEYS
    ]
    target = np.concatenate([rows.series[key].target for key in KEYS])
    return np.vstack(columns) / LOUD, target / LOUD


def marginal(rows: Linearisation, among: Sequence[Hypothesis]) -> float:
    """Log density of the rows where coefficients are drawn from their priors."""
    A, y = stacked(rows, among)
    mean = np.concatenate([each.mean for each in among])
    variance = 1.0 / np.concatenate([each.precision for each in among])
    cov = np.eye(len(y)) + (A * variance) @ A.T
    return float(stats.multivariate_normal(A @ mean, cov).logpdf(y))


@pytest.mark.parametrize("seed", range(4))
def test_the_evidence_of_a_cause_is_the_ratio_of_marginal_densities(seed: int) -> None:
    rows = data(seed)
    among = [hypothesis(0, 2), hypothesis(1, 1, KEYS[:1]), hypothesis(2, 3, KEYS[1:])]
    fewer = Model(rows, among[:2])
    expected = marginal(rows, among) - marginal(rows, among[:2])
    assert fewer.with_(among[2]).log_evidence - fewer.log_evidence == pytest.approx(expected)
    assert Model(rows, among).without(among[2]).log_evidence == pytest.approx(fewer.log_evidence)


@pytest.mark.parametrize("seed", range(4))
def test_a_pool_scores_each_candidate_as_a_model_with_it_would(seed: int) -> None:
    rows = data(seed)
    model = Model(rows, [hypothesis(0, 2), hypothesis(1, 1, KEYS[:1])])
    pool = [hypothesis(10, 1), hypothesis(11, 3, KEYS[1:]), hypothesis(12, 2, KEYS[:1])]
    scored = Pool(rows, pool).scored(model)
    assert len(scored) == 3
    assert [each.log_odds for each in scored] == sorted((e.log_odds for e in scored), reverse=True)
    for each in scored:
        wider = model.with_(each.hypothesis)
        assert each.log_odds == pytest.approx(wider.log_posterior - model.log_posterior, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_what_cannot_be_negative_is_where_scipys_bounded_least_squares_has_it(seed: int) -> None:
    rows = data(seed)
    among = [hypothesis(k, 1, positive=k > 0) for k in range(4)]
    among = [replace(each, mean=np.zeros(1)) for each in among]
    A, y = stacked(rows, among)
    scale = np.sqrt(np.concatenate([each.precision for each in among]))
    low = np.where([each.positive for each in among], 0.0, -np.inf)
    whole = np.vstack([A / scale, np.eye(4)])
    expected = optimize.lsq_linear(whole, np.append(y, np.zeros(4)), (low, np.inf), tol=1e-14).x
    found = Model(rows, among).beta * scale
    assert found == pytest.approx(expected, abs=1e-6)


def test_noise_is_what_is_left_for_each_coefficient_that_was_learnt() -> None:
    """Of white noise its variance, though half as many coefficients as rows are fitted to it."""
    rows = data(3, floor=1e-3)
    rng = np.random.default_rng(5)
    columns = rng.standard_normal((COUNT, COUNT // 2))
    term = Term(
        effect="torque_offset",
        place=Place(joints=(0,)),
        shape=(),
        columns={KEYS[0]: columns},
        prior=np.ones(COUNT // 2),
    )
    wide = Hypothesis(term=term, mean=np.zeros(COUNT // 2), precision=np.full(COUNT // 2, 1e-4))
    model = Model(rows, [wide])
    left = model.left(KEYS[0])
    assert float(np.mean(left**2)) < 0.65
    assert model.noise[KEYS[0]] == pytest.approx(1.0, abs=0.3)


@pytest.mark.parametrize("colour", [0.0, 0.5, 0.9])
def test_rows_that_err_alike_count_as_few(colour: float) -> None:
    rng = np.random.default_rng(0)
    white = rng.standard_normal(40_000)
    for t in range(1, len(white)):
        white[t] = colour * white[t - 1] + np.sqrt(1 - colour**2) * white[t]
    whole = slice(0, len(white))
    series = Series(rows=np.arange(len(white)), target=white, floor=1.0, parts=(whole,))
    assert series.repeats(white) == pytest.approx((1 + colour) / (1 - colour), rel=0.1)


# Intervals of effects on a real arm's balances

TRUE = {"coefficient": 0.7, "offset": -0.4, "stiffness": 2.0, "onset": 0.5}
NOISE = 0.6  # of each sample's torque [N m]
DAY = 0.1  # share by which friction is another one each day
DRAWS = 40


def repeated(folder: Path, colour: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, half widths and whether the truth is inside, (draws, parameters)."""
    motion = moved(folder, 2, seconds=30.0, tau_cmd=None, q_des=None, dq_des=None)
    joint, spring = Place(joints=(1,)), CATALOGUE["position_dependent_spring"]
    truth = motion.tau.copy()
    truth[:, 1] += TRUE["offset"]
    truth[:, 1] += TRUE["stiffness"] * np.maximum(motion.q[:, 1] - TRUE["onset"], 0.0)
    values, halves, inside = [], [], []
    for draw in range(DRAWS):
        rng = np.random.default_rng(draw)
        noise = rng.standard_normal(truth.shape)
        if colour:  # first-order, forgotten within a block
            for t in range(1, len(noise)):
                noise[t] = colour * noise[t - 1] + np.sqrt(1 - colour**2) * noise[t]
        torque = truth + NOISE * noise
        torque[:, 1] += (1.0 + DAY * rng.standard_normal()) * TRUE["coefficient"] * motion.dq[:, 1]
        b = Balances([replace(motion, torque=torque, cache={})])
        posterior = Posterior.of(b)
        beside = posterior.fit_of(posterior.begun(BODIES).model)
        term = term_of(b, spring, joint, (1.0, 0.45))
        assert term is not None
        moved_on = posterior.reshaped(beside, peculiar(b, term))
        fit = posterior.fit_of(posterior.begun(BODIES, [moved_on]).model)
        row = []
        for effect, names in (
            ("viscous_friction", ("coefficient",)),
            ("torque_offset", ("offset",)),
            (spring.id, ("stiffness", "onset")),
        ):
            (own,) = (t for t in fit.terms if t.effect == effect and t.place == joint)
            found = estimates(fit, (own,), draw)[0]
            row += [found[name] for name in names]
        values.append([e.value for e in row])
        halves.append([0.5 * (e.interval95[1] - e.interval95[0]) for e in row])
        inside.append(
            [e.interval95[0] <= TRUE[n] <= e.interval95[1] for n, e in zip(TRUE, row, strict=True)]
        )
    return np.array(values), np.array(halves), np.array(inside)


@pytest.mark.parametrize("colour", [0.0, 0.95])
def test_intervals_hold_the_truth_about_as_often_as_they_say(tmp_path: Path, colour: float) -> None:
    values, halves, inside = repeated(tmp_path, colour)
    assert inside.mean(axis=0) == pytest.approx(0.925, abs=0.0751)  # 85 to 100 %
    assert inside.mean() > 0.88
    spread = values.std(axis=0)
    # Neither a lucky centre nor a useless width.
    off = np.abs(values.mean(axis=0) - list(TRUE.values()))
    assert off == pytest.approx(0.0, abs=3.5 * spread.max() / np.sqrt(DRAWS))
    ratio = np.median(halves, axis=0) / (1.96 * spread)
    assert (ratio > 0.7).all()
    assert (ratio < 2.5).all()  # the arm's model is right; it might have been a little off
