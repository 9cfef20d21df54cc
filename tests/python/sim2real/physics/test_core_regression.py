"""Least squares over all balances against NumPy and SciPy."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from scipy import optimize

pytest.importorskip("pinocchio", reason="pip install 'pdoik[sim2real]'")

from pdoik.sim2real.motion import Place
from pdoik.sim2real.regression import Fit, OneMore, Term
from pdoik.sim2real.thresholds import Thresholds

KEYS = (("torque", 0), ("torque", 1), ("drive", 1))
COUNT = 600


@dataclass(eq=False)
class Rows:
    """Balances of made-up numbers: what a fit asks of them."""

    residual: dict[Any, np.ndarray]
    mask: dict[Any, np.ndarray]
    sigma: dict[Any, float]
    fold: np.ndarray
    block: np.ndarray
    thresholds: Thresholds = field(default_factory=Thresholds)

    @property
    def keys(self) -> tuple[Any, ...]:
        return tuple(self.residual)

    @property
    def count(self) -> int:
        return len(self.fold)


def rows(seed: int) -> Rows:
    rng = np.random.default_rng(seed)
    place = np.arange(COUNT)
    return Rows(
        residual={key: rng.standard_normal(COUNT) for key in KEYS},
        mask={key: rng.random(COUNT) < 0.8 for key in KEYS},
        sigma=dict(zip(KEYS, (0.3, 1.7, 0.05), strict=True)),
        fold=place * 4 // COUNT,
        block=place // 20,
    )


def term(seed: int, effect: str, width: int, keys: Any = KEYS, prior: float = 0.0) -> Term:
    rng = np.random.default_rng(1000 + seed)
    scale = 10.0 ** rng.uniform(-4, 4, width)  # N m per rad/s beside N m per kg m^2
    return Term(
        effect=effect,
        place=Place(joints=(seed,)),
        shape=(),
        columns={key: scale * rng.standard_normal((COUNT, width)) for key in keys},
        prior=prior * rng.random(width) * scale**2,
    )


def terms() -> list[Term]:
    return [
        term(0, "free", 2),
        term(1, "actuator_lag", 1, KEYS[2:]),  # its coefficient is one
        term(2, "payload", 10, KEYS[:2], prior=30.0),
        term(3, "viscous_friction", 1, KEYS[:1]),
    ]


def stacked(b: Rows, among: list[Term], use: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """Design and target of all rows that count, in sigmas, and the prior's rows below."""
    design, target = [], []
    free = [t for t in among if not t.fixed]
    for key in b.keys:
        at = b.mask[key] & (True if use is None else use)
        each = [t.columns.get(key, np.zeros((COUNT, t.width)))[at] / b.sigma[key] for t in free]
        known = sum(t.columns[key][:, 0] for t in among if t.fixed and key in t.columns)
        design.append(np.hstack(each))
        target.append((b.residual[key] - known)[at] / b.sigma[key])
    prior = np.concatenate([t.prior for t in free])
    design.append(np.diag(np.sqrt(prior)))
    target.append(np.zeros(len(prior)))
    return np.vstack(design), np.concatenate(target)


@pytest.mark.parametrize("seed", range(5))
def test_coefficients_are_those_of_numpys_least_squares(seed: int) -> None:
    b = rows(seed)
    fit = Fit(b, terms())
    A, y = stacked(b, terms())
    expected, *_ = np.linalg.lstsq(A / np.linalg.norm(A, axis=0), y, rcond=None)
    expected /= np.linalg.norm(A, axis=0)
    assert fit.beta == pytest.approx(expected, rel=1e-6)
    assert fit.cost() == pytest.approx(float(np.sum((y - A @ expected) ** 2)), rel=1e-9)
    left = np.concatenate([fit.residual(key) for key in KEYS])
    assert left == pytest.approx((y - A @ expected)[: len(left)], abs=1e-7)


@pytest.mark.parametrize("seed", range(5))
def test_bounded_coefficients_are_those_of_scipys_bounded_least_squares(seed: int) -> None:
    b = rows(seed)
    # More friction is wanted than none: the other way round for odd seeds.
    rubs = term(3, "viscous_friction", 1, KEYS[:1])
    sign = 1.0 if seed % 2 else -1.0
    b.residual["torque", 0] += (
        sign * 0.5 * rubs.columns["torque", 0][:, 0] / np.std(rubs.columns["torque", 0])
    )
    among = [term(0, "free", 2), rubs, term(2, "payload", 10, KEYS[:2], prior=30.0)]
    fit = Fit(b, among)
    A, y = stacked(b, among)
    scale = np.linalg.norm(A, axis=0)
    low, high = np.full(13, -np.inf), np.full(13, np.inf)
    low[2] = low[3] = 0.0  # of viscous friction, and a payload's mass
    expected = optimize.lsq_linear(A / scale, y, (low * 1.0, high), tol=1e-14).x / scale
    found = fit.bounded()
    assert (found >= low).all()
    assert found * scale == pytest.approx(expected * scale, abs=1e-5)
    assert (found[2] == pytest.approx(0.0, abs=1e-9 / scale[2])) == (sign < 0)
    if (fit.beta >= low).all():
        assert found == pytest.approx(fit.beta)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2)])
def test_an_extended_fit_is_a_fresh_one(order: tuple[int, ...]) -> None:
    b, among = rows(7), terms()
    grown = Fit(b, [])
    for i in order:
        grown = grown.extended(among[i])
    fresh = Fit(b, [among[i] for i in order])
    at_once = Fit(b, [among[order[0]]]).extended(*(among[i] for i in order[1:]))
    for other in (grown, at_once):
        assert other.terms == fresh.terms
        assert other.beta == pytest.approx(fresh.beta, rel=1e-7)
        assert other.cost() == pytest.approx(fresh.cost(), rel=1e-10)
        for key in KEYS:
            assert other.residual(key) == pytest.approx(fresh.residual(key), abs=1e-8)
            assert other.held_out()[key] == pytest.approx(fresh.held_out()[key], abs=1e-7)
    assert np.array_equal(grown.offsets, fresh.offsets)


@pytest.mark.parametrize("gone", [(0,), (1,), (2,), (1, 3), (0, 1, 2, 3)])
def test_a_fit_without_terms_is_a_fresh_one(gone: tuple[int, ...]) -> None:
    b, all_terms = rows(6), terms()
    kept = [each for k, each in enumerate(all_terms) if k not in gone]
    fresh = Fit(b, kept)  # type: ignore[arg-type]
    fewer = Fit(b, all_terms).without(*(all_terms[k] for k in gone))  # type: ignore[arg-type]
    assert fewer.terms == fresh.terms
    np.testing.assert_allclose(fewer.fold_gram, fresh.fold_gram, rtol=1e-9)
    np.testing.assert_allclose(fewer.fold_moment, fresh.fold_moment, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(fewer.beta, fresh.beta, rtol=1e-9)
    assert fewer.cost() == pytest.approx(fresh.cost(), rel=1e-12)
    for key in KEYS:
        np.testing.assert_allclose(fewer.held_out()[key], fresh.held_out()[key], atol=1e-9)
        np.testing.assert_array_equal(fewer.index[key], fresh.index[key])


@pytest.mark.parametrize("added", range(4))
def test_one_term_more_does_what_the_extended_fit_does(added: int) -> None:
    b, all_terms = rows(7), terms()
    fit = Fit(b, [each for k, each in enumerate(all_terms) if k != added])  # type: ignore[arg-type]
    expected = fit.cost() - fit.extended(all_terms[added]).cost()
    assert OneMore(fit).gain(all_terms[added]) == pytest.approx(expected, rel=1e-7)
    assert abs(expected) > 1e-3
    bare = Fit(b, ())  # type: ignore[arg-type]
    alone = bare.cost() - Fit(b, [all_terms[added]]).cost()  # type: ignore[arg-type]
    assert OneMore(bare).gain(all_terms[added]) == pytest.approx(alone, rel=1e-7)


def test_held_out_rows_are_predicted_by_a_fit_without_their_fold() -> None:
    b, among = rows(8), terms()
    fit = Fit(b, among)
    held = fit.held_out()
    for f in range(4):
        A, y = stacked(b, among, b.fold != f)
        scale = np.linalg.norm(A, axis=0)
        beta = np.linalg.lstsq(A / scale, y, rcond=None)[0] / scale
        A, y = stacked(b, among, b.fold == f)
        size = len(beta)
        expected = (y - A @ beta)[:-size]
        at = [b.fold[b.mask[key]] == f for key in KEYS]
        found = np.concatenate([held[key][i] for key, i in zip(KEYS, at, strict=True)])
        assert found == pytest.approx(expected, abs=1e-6)
    training = sum(float(np.sum(fit.residual(key) ** 2)) for key in KEYS)
    assert sum(float(np.sum(left**2)) for left in held.values()) > training


def test_a_fit_of_nothing_leaves_everything() -> None:
    b = rows(10)
    fit = Fit(b, [])
    assert fit.beta.shape == fit.bounded().shape == (0,)
    for key in KEYS:
        assert fit.residual(key) == pytest.approx(b.residual[key][b.mask[key]] / b.sigma[key])


def test_columns_that_say_the_same_share_what_they_explain() -> None:
    b = rows(11)
    one = term(4, "free", 1)
    fit = Fit(b, [one, replace(one, place=Place(joints=(5,)))])
    alone = Fit(b, [one])
    assert fit.beta.sum() == pytest.approx(alone.beta[0], rel=1e-4)
    assert np.abs(fit.beta).max() < 1e3 * np.abs(alone.beta[0])
    assert fit.cost() == pytest.approx(alone.cost(), rel=1e-6)
