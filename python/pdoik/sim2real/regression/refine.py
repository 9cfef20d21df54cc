"""Nonlinear parameters, moved to where the training cost is lowest."""

from __future__ import annotations

import numpy as np
from scipy import optimize

from ..effects import CATALOGUE
from ..study.recording import FloatArray
from .fit import Fit, Term
from .one_more import OneMore
from .trial import Search


def refined(base: Fit, term: Term) -> Term:
    """The term with its nonlinear parameters moved to where the training cost is lowest."""
    effect = CATALOGUE[term.effect]
    free = [i for i, (low, high) in enumerate(effect.shape_bounds(term.shape)) if high - low > 1e-9]
    if not free:
        return term
    bounds, beside = effect.shape_bounds(term.shape), OneMore(base)

    def at(values: FloatArray) -> tuple[float, Term]:
        shape = list(term.shape)
        for i, value in zip(free, values, strict=True):
            shape[i] = float(np.clip(value, *bounds[i]))
        columns = base.balances.compute(effect, term.place, tuple(shape))
        new = Term(
            effect=term.effect,
            place=term.place,
            shape=tuple(shape),
            columns=columns,
            prior=term.prior,
        )
        if not columns:
            return 2.0 * beside.cost + 1.0, new  # worse than without it; infinity upsets SciPy
        return beside.cost_with(new), new

    if effect.costly:
        here = term.shape[0]
        tries = [here * 1.06**power for power in range(-6, 7)]  # simulated along with one another
        costs = [at(np.array([value]))[0] for value in tries]
        best, cost = np.array([tries[int(np.argmin(costs))]]), float(min(costs))
    elif len(free) == 1:
        low, high = bounds[free[0]]
        found = optimize.minimize_scalar(
            lambda x: at(np.array([x]))[0],
            bounds=(low, high),
            method="bounded",
            options={"xatol": 2e-3 * (high - low), "maxiter": 18},
        )
        best, cost = np.array([found.x]), float(found.fun)
    else:
        start = np.array([term.shape[i] for i in free])
        result = optimize.minimize(  # type: ignore[call-overload]  # its stubs know no fatol
            lambda x: at(x)[0],
            start,
            method="Nelder-Mead",
            bounds=[bounds[i] for i in free],
            options={"maxfev": 60, "xatol": 1e-3, "fatol": 1.0},
        )
        best, cost = result.x, float(result.fun)
    return at(best)[1] if cost < beside.cost_with(term) else term


def polished(state: Search, joints: set[int] | None = None) -> Search:
    """Nonlinear parameters moved once more with all terms there; of these joints, or of all.

    A shape found before its neighbours were there may have stood in for them.
    """
    for term in state.accepted:
        if not CATALOGUE[term.effect].shape_bounds(term.shape):
            continue
        if joints is not None and joints.isdisjoint(term.place.joints):
            continue
        better = refined(state.without(term).fit, term)
        state = state.fitted([better if t is term else t for t in state.fit.terms])
    return state
