"""What a model leaves of a cause that is not in the rows, against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.identify import Hypothesis, Linearisation, Model, remainder
from sim2real_evidence_rows import TORQUES, believed, data_of, priors, stacked, term, weights


def made(seed: int) -> tuple[Linearisation, list[Hypothesis], Hypothesis, dict[str, float]]:
    """Rows, what is believed of all else, a cause, and known noise."""
    rng = np.random.default_rng(seed)
    data = data_of(rng)
    others = [believed(rng, term(rng, 3)), believed(rng, term(rng, 2, TORQUES[:1]))]
    noise = {key: 0.3 + 0.2 * k for k, key in enumerate(data.series)}
    return data, others, believed(rng, term(rng, 1)), noise


@pytest.mark.parametrize("seed", range(4))
def test_the_information_is_that_of_the_posterior_with_the_cause_in_it(seed: int) -> None:
    data, others, cause, noise = made(seed)
    model = Model(data, others, noise=noise)
    assert model.noise == noise
    left = remainder(model, {key: c[:, 0] for key, c in cause.term.columns.items()})
    whole = Model(data, [*others, cause], noise=noise)
    variance = whole.variances[whole.span(cause)][0]
    assert 1.0 / variance == pytest.approx(left.information + cause.precision[0], rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_left_is_that_of_dense_ridge_regression(seed: int) -> None:
    data, others, cause, noise = made(seed)
    model = Model(data, others, noise=noise)
    contribution = {key: 0.7 * c[:, 0] for key, c in cause.term.columns.items()}
    left = remainder(model, contribution)
    design, _ = stacked(data, others, weights(model))
    target, _ = stacked(data, [cause], weights(model))
    target = 0.7 * target[:, 0]
    mean, precision = priors(others)
    square = design.T @ design + np.diag(precision)
    taken = np.linalg.solve(square, design.T @ target + precision * mean)
    assert left.coefficients == pytest.approx(taken, rel=1e-6, abs=1e-9)
    away = taken - mean
    cost = float(np.sum((target - design @ taken) ** 2) + precision @ away**2)
    assert left.information == pytest.approx(cost, rel=1e-6)
    assert 0.0 < left.log_ratio <= 0.5 * left.information + 1e-9
    assert left.share <= 1.0


def test_models_made_of_one_keep_its_known_noise() -> None:
    data, others, cause, noise = made(0)
    model = Model(data, others, noise=noise)
    assert model.with_(cause).noise == noise
    assert model.without(others[0]).noise == noise
