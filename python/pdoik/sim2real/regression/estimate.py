"""Values of what was found, with intervals from blocks, and from recordings or sessions.

The block bootstrap says how sure a figure is if all recordings are of one machine in one state.
Machines change from session to session. Where the study tells which recordings are of one session,
each session's own figures say by how much: that spread is reported, and widens the interval. Where
it does not, the jackknife over recordings sees such changes, and what it sees beyond the bootstrap
widens the interval (Bell and McCaffrey, Survey Methodology 28(2), 2002).
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from ..effects import CATALOGUE
from ..findings import Estimate
from ..motion.balances import Balances
from ..study.recording import FloatArray
from ..thresholds.figures import FigureThresholds
from .by_session import BySession, by_session, figure_by_session
from .fit import Fit, Term
from .random_effects import Spread, spread_between
from .wald import robust

DRAWS = 200


def estimates(fit: Fit, wanted: tuple[Term, ...], seed: int) -> dict[int, dict[str, Estimate]]:
    """Parameters of each wanted term, by its index in `wanted`.

    Nonlinear parameters take part by the derivative of their columns: the bootstrap's step along
    it is the parameter's. Intervals hold for the mean over sessions like those recorded.
    """
    if not wanted:
        return {}
    rng = np.random.default_rng(seed)
    moving = [(term, i) for term in wanted for i in CATALOGUE[term.effect].free(term.shape)]
    extra = [_sensitivity(fit, term, i) for term, i in moving]
    wider = fit.extended(*extra) if extra else fit
    draws = wider.bootstrap(rng, DRAWS)
    left_out = wider.without_each_recording(draws.std(axis=0))
    sessions = by_session(wider)
    centre = wider.beta
    # Directions no motion shows do not move in the bootstrap: their prior's spread is added.
    unseen = _unseen(wider)
    if unseen is not None:
        draws = draws + rng.standard_normal((len(draws), len(unseen))) @ unseen
    result: dict[int, dict[str, Estimate]] = {}
    bounded = fit.bounded()
    for number, term in enumerate(wanted):
        at = fit.terms.index(term)
        span = slice(int(fit.offsets[at]), int(fit.offsets[at]) + (0 if term.fixed else term.width))
        beta = np.ones(1) if term.fixed else bounded[span]
        own = [
            (i, int(offset))
            for (owner, i), offset in zip(moving, wider.offsets[len(fit.terms) :], strict=False)
            if owner is term
        ]

        def parameters(
            draw: FloatArray,
            term: Term = term,
            own: list[tuple[int, int]] = own,
            beta: FloatArray = beta,
            span: slice = span,
        ) -> dict[str, float]:
            shape = list(term.shape)
            for i, offset in own:
                shape[i] += float(draw[offset] - centre[offset]) * _step(term, i)
            sample = beta if term.fixed else beta + draw[span] - centre[span]
            return CATALOGUE[term.effect].values(tuple(shape), sample)

        by_blocks = [parameters(draw) for draw in draws]
        by_recordings = [parameters(draw) for draw in left_out]
        values = CATALOGUE[term.effect].values(term.shape, beta)
        units = {p.name: p.unit for p in CATALOGUE[term.effect].parameters}
        spreads = {
            name: _spread(
                fit.balances.thresholds.figures,
                value,
                figure_by_session(sessions, lambda draw, name=name: parameters(draw)[name]),  # type: ignore[misc]
                units.get(name, "-"),
            )
            for name, value in values.items()
            if sessions
        }
        result[number] = {
            name: _estimate(
                fit.balances.thresholds.figures,
                value,
                np.array([each[name] for each in by_blocks]),
                np.array([each[name] for each in by_recordings]),
                units.get(name, "-"),
                spreads.get(name),
            )
            for name, value in values.items()
        }
    return result


def values_and_errors(
    found: dict[int, dict[str, Estimate]],
) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
    """Values and standard errors of `estimates`, by the terms' index."""
    each = [found[number] for number in range(len(found))]
    return (
        [{name: e.value for name, e in one.items()} for one in each],
        [{name: e.std for name, e in one.items()} for one in each],
    )


def event_estimates(fit: Fit, term: Term) -> dict[str, Estimate]:
    """Parameters of an event, the fit's last term: too short for a bootstrap of blocks.

    Errors are cluster-robust, of clusters within its window.
    """
    effect = CATALOGUE[term.effect]
    std = np.sqrt(np.diag(robust(fit, term)))
    units = {p.name: p.unit for p in effect.parameters}
    values = effect.values(term.shape, fit.beta[-term.width :])
    return {
        name: Estimate(
            value=value,
            std=float(s),
            interval95=(value - 1.96 * float(s), value + 1.96 * float(s)),
            unit=units.get(name, "-"),
        )
        for (name, value), s in zip(values.items(), std, strict=True)
    }


def _estimate(
    least: FigureThresholds,
    value: float,
    by_blocks: FloatArray,
    by_recordings: FloatArray,
    unit: str,
    spread: Spread | None,
) -> Estimate:
    if unit == "rad":  # a phase may wrap
        by_blocks, by_recordings = _near(value, by_blocks), _near(value, by_recordings)
    std = float(np.hypot(np.std(by_blocks), least.discretisation * abs(value)))
    low, high = np.quantile(by_blocks, (0.025, 0.975))
    # Centred on the value: the bootstrap's own bias is not the estimate's.
    half = max(float(high - low) / 2, 1.96 * std)
    if spread is not None:
        half = max(half, spread.half_width(half / 1.96))
        return Estimate(
            value=value,
            std=float(np.hypot(std, spread.error)),
            interval95=(value - half, value + half),
            unit=unit,
            spread=spread.std if spread.sessions > 1 else None,
            spread_p=spread.p if spread.sessions > 1 else None,
        )
    between, freedom = 0.0, 1
    if len(by_recordings) >= least.fewest_sessions:
        between, freedom = _between_sessions(by_recordings, std)
    half = float(np.hypot(half, stats.t.ppf(0.975, freedom) * between))
    std = float(np.hypot(std, between))
    return Estimate(value=value, std=std, interval95=(value - half, value + half), unit=unit)


def _spread(least: FigureThresholds, value: float, by_sessions: BySession, unit: str) -> Spread:
    """Between sessions."""
    values = by_sessions.values
    if unit == "rad":
        values = _near(value, values)
    variances = by_sessions.variances + (least.discretisation * value) ** 2
    return spread_between(values, variances, by_sessions.freedom)


def _near(value: float, angles: FloatArray) -> FloatArray:
    return np.asarray(value + (angles - value + np.pi) % (2 * np.pi) - np.pi)


def _between_sessions(by_recordings: FloatArray, std: float) -> tuple[float, int]:
    """Standard error by differences between recordings beyond `std`, and degrees of freedom."""
    count = len(by_recordings)
    squares = (count - 1) / count * float(np.sum((by_recordings - by_recordings.mean()) ** 2))
    return float(np.sqrt(max(squares - std**2, 0.0))), count - 1


def _step(term: Term, i: int) -> float:
    size = abs(term.shape[i])
    step = 0.02 * max(size, 0.02)
    return min(step, 0.25 * size) if size else step  # a time stays positive


def _sensitivity(fit: Fit, term: Term, i: int) -> Term:
    """Change of a term's contribution per step of a nonlinear parameter."""
    b: Balances = fit.balances
    effect, step = CATALOGUE[term.effect], _step(term, i)
    at = fit.terms.index(term)
    offset = int(fit.offsets[at])
    beta = np.ones(1) if term.fixed else fit.beta[offset : offset + term.width]
    sides = []
    for sign in (1.0, -1.0):
        shape = list(term.shape)
        shape[i] += sign * step
        sides.append(b.compute(effect, term.place, tuple(shape)))
    columns = {
        key: ((sides[0][key] - sides[1][key]) @ beta / 2.0)[:, None]
        for key in sides[0]
        if key in sides[1]
    }
    return Term(effect="shape", place=term.place, shape=(), columns=columns, prior=np.full(1, 1e-3))


def _unseen(fit: Fit) -> FloatArray | None:
    """Square root of the prior's covariance along directions that data leave to it, or None."""
    if not fit.size or not np.any(fit.prior > 0.0):
        return None
    which = np.flatnonzero(fit.prior > 0.0)
    scale = 1.0 / np.sqrt(fit.prior[which])
    covariance = np.linalg.inv(fit.regular(fit.gram))[np.ix_(which, which)]
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    kept = np.where(values > 0.05, np.sqrt(np.maximum(values, 0.0)), 0.0)
    root = np.zeros((len(which), fit.size))
    root[:, which] = (vectors * kept).T * scale
    return root
