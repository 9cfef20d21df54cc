"""Figures of effects whose columns are of first order only, moved to where they hold exactly."""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..findings import Estimate
from ..motion import Key
from .fit import Fit, Term

_ROUNDS = 3


def to_second_order(fit: Fit, term: Term, estimates: dict[str, Estimate]) -> dict[str, Estimate]:
    """Estimates whose exact contribution fits as well as the regression's linear one did.

    Gauss-Newton with the regression's columns: what the exact contribution differs by from the
    linear one is fitted by all terms together, and taken off.
    """
    effect = CATALOGUE[term.effect]
    start = {name: each.value for name, each in estimates.items()}
    values = dict(start)
    span = fit.span(term)
    for _ in range(_ROUNDS):
        beta = effect.coefficients(values, term.shape)[1]
        exact = _exactly(fit, term, values)
        if exact is None:
            return estimates
        moment = np.zeros(fit.size)
        for key, contribution in exact.items():
            rows = fit.rows[key]
            beyond = (contribution - term.columns[key] @ beta)[rows] / fit.balances.sigma[key]
            moment[fit.index[key]] -= fit.design[key].T @ beyond
        moved = effect.coefficients(start, term.shape)[1] + fit.solve(fit.gram, moment)[span]
        values = effect.values(term.shape, moved)
    return {name: each.moved(values[name]) for name, each in estimates.items()}


def _exactly(fit: Fit, term: Term, values: dict[str, float]) -> dict[Key, FloatArray] | None:
    b, effect = fit.balances, CATALOGUE[term.effect]
    parts: dict[Key, list[FloatArray]] = {}
    for i, motion in enumerate(b.motions):
        columns = effect.exactly(motion, term.place, values)
        if columns is None:
            return None
        for key, column in columns.items():
            parts.setdefault(key, []).append(b.thin(i, column[:, 0]))
    return {key: np.concatenate(each) for key, each in parts.items() if key in term.columns}
