"""Values with intervals: the posterior of the coefficients, and of shapes by their derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import linalg

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..findings import ERRORS, Estimate
from ..motion import Balances
from ..regression import Fit, Term, spread_between
from .ordinary import days_of

DRAWS = 400
_NOTHING = 1e-6  # of what was believed is left, that sums can be solved
_SHAPE_PRIOR = 1e-3  # inverse variance of a shape's step

Figures = dict[int, dict[str, Estimate]]


def estimates(fit: Fit, wanted: tuple[Term, ...], seed: int) -> Figures:
    """Parameters of each wanted term, by its index in `wanted`.

    Normal about the likeliest coefficients, with the covariance of all that is in the fit: what
    other causes, bodies within trust and days leave open is in the intervals. Nonlinear parameters
    take part by the derivative of their columns.
    """
    if not wanted:
        return {}
    moving = [(term, i) for term in wanted for i in CATALOGUE[term.effect].free(term.shape)]
    wider = fit.extended(*(_sensitivity(fit, term, i) for term, i in moving)) if moving else fit
    root = _root(wider)
    rng = np.random.default_rng(seed)
    draws = rng.standard_normal((DRAWS, wider.size)) @ root
    bounded = fit.bounded()
    result: Figures = {}
    for number, term in enumerate(wanted):
        span = fit.span(term)
        beta = np.ones(1) if term.fixed else bounded[span]
        effect = CATALOGUE[term.effect]
        own = [
            (i, int(offset))
            for (owner, i), offset in zip(moving, wider.offsets[len(fit.terms) : -1], strict=True)
            if owner is term
        ]
        samples = []
        for draw in draws:
            shape = list(term.shape)
            for i, offset in own:
                shape[i] += float(draw[offset]) * _step(term, i)
            sample = beta if term.fixed else beta + draw[span]
            samples.append(effect.values(tuple(shape), sample))
        result[number] = {
            name: _estimate(
                fit, value, np.array([each[name] for each in samples]), effect.unit_of(name)
            )
            for name, value in effect.values(term.shape, beta).items()
        }
        if effect.function:
            size = {"size": _size(fit, root, term)}
            result[number] = size | result[number]
        if not term.fixed and term.width == 1:
            result[number] = _with_spread(fit, root, term, span.start, result[number])
    return result


def _root(fit: Fit) -> FloatArray:
    """A matrix R with R'R the covariance of the coefficients."""
    scale, even = fit.even(fit.gram)
    lower = linalg.cholesky(even, lower=True)
    return np.asarray(linalg.solve_triangular(lower, np.diag(scale), lower=True))


def _size(fit: Fit, root: FloatArray, term: Term) -> Estimate:
    """What a function comes to along the motion, root mean square, as sure as all its values are.

    Each of them may be nothing where a level or a slope of it is as well another part's.
    """
    span = fit.span(term)
    beta = fit.beta[span]
    parts = [columns[fit.rows[key]] @ beta for key, columns in term.columns.items()]
    size = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
    own = root[:, span].T @ root[:, span]
    square = float(beta @ np.linalg.lstsq(own, beta, rcond=None)[0])  # of its errors from nothing
    return Estimate.normal(size, size / max(np.sqrt(max(square, 0.0)), 1e-9), "N m")


def _estimate(fit: Fit, value: float, samples: FloatArray, unit: str) -> Estimate:
    if unit == "rad":  # a phase may wrap
        samples = value + (samples - value + np.pi) % (2 * np.pi) - np.pi
    least = fit.balances.thresholds.priors.discretisation * abs(value)
    low, high = np.quantile(samples, (0.025, 0.975))
    std = float(np.hypot((high - low) / 3.92, least))
    return Estimate.normal(value, std, unit)


def _with_spread(
    fit: Fit, root: FloatArray, term: Term, at: int, figures: dict[str, Estimate]
) -> dict[str, Estimate]:
    """How much a joint's friction differs between sessions, where the study gives sessions."""
    if fit.balances.told is None:
        return figures
    own = days_of(fit.terms, term)
    days = [fit.span(day).start for day in own]
    if len(days) < 2:
        return figures
    believed = np.concatenate([term.prior, *(day.prior for day in own)])
    most = fit.balances.thresholds.diagnosis.silent
    values, variances = _of_sessions(fit.beta[[at, *days]], root[:, [at, *days]], believed, most)
    if np.isfinite(variances).sum() < 2:
        return figures
    found = spread_between(values, variances, fit.balances.count)
    name = next(iter(figures))
    each = figures[name]
    alike = float(np.sum(1.0 / variances)) ** -0.5
    half = max(ERRORS * each.std, found.half_width(alike))
    interval = (each.value - half, each.value + half)
    widened = replace(each, interval95=interval, spread=found.std, spread_p=found.p)
    return {**figures, name: widened}


def _of_sessions(
    beta: FloatArray, root: FloatArray, believed: FloatArray, most: float
) -> tuple[FloatArray, FloatArray]:
    """Each session's own figure and its variance, by its rows alone: what was believed taken off.

    Args:
        beta: (1 + S,) the figure of all sessions, and what each differs by.
        root: (n, 1 + S) of which R'R is their covariance.
        believed: (1 + S,) inverse variances of both before any row.
        most: times the variance before any row, from which a session says nothing.
    """
    sums = np.concatenate([np.ones((len(beta) - 1, 1)), np.eye(len(beta) - 1)], axis=1)
    before = linalg.inv((sums / believed) @ sums.T)
    after = linalg.inv(sums @ (root.T @ root) @ sums.T)
    precision = after - (1.0 - _NOTHING) * before
    variances = np.diag(linalg.inv(precision)).copy()
    values = linalg.solve(precision, after @ (sums @ beta))
    silent = variances > most * np.diag(linalg.inv(before))
    variances[silent] = np.inf
    return values, variances


def values_and_errors(
    found: Figures,
) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
    """Values and standard errors of `estimates`, by the terms' index."""
    each = [found[number] for number in range(len(found))]
    return (
        [{name: e.value for name, e in one.items()} for one in each],
        [{name: e.std for name, e in one.items()} for one in each],
    )


def event_estimates(fit: Fit, term: Term) -> dict[str, Estimate]:
    """Parameters of an event in recordings that were held out: the fit's last term."""
    effect = CATALOGUE[term.effect]
    std = np.sqrt(np.sum(_root(fit) ** 2, axis=0))[-term.width :]
    values = effect.values(term.shape, fit.beta[-term.width :])
    return {
        name: Estimate.normal(value, float(s), effect.unit_of(name))
        for (name, value), s in zip(values.items(), std, strict=True)
    }


def _step(term: Term, i: int) -> float:
    size = abs(term.shape[i])
    step = 0.02 * max(size, 0.02)
    return min(step, 0.25 * size) if size else step  # a time stays positive


def _sensitivity(fit: Fit, term: Term, i: int) -> Term:
    """Change of a term's contribution per step of a nonlinear parameter."""
    b: Balances = fit.balances
    effect, step = CATALOGUE[term.effect], _step(term, i)
    beta, sides = fit.beta_of(term), []
    for sign in (1.0, -1.0):
        shape = list(term.shape)
        shape[i] += sign * step
        sides.append(b.compute(effect, term.place, tuple(shape)))
    columns = {
        key: ((sides[0][key] - sides[1][key]) @ beta / 2.0)[:, None]
        for key in sides[0]
        if key in sides[1]
    }
    prior = np.full(1, _SHAPE_PRIOR)
    return Term(effect="shape", place=term.place, shape=(), columns=columns, prior=prior)
