"""Nonlinear parameters, moved to where the training cost is lowest."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy import optimize

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from .fit import Fit, Term, term_of
from .one_more import OneMore

Values = FloatArray | float
_GRID = 7  # values of one parameter that are looked at first


def refined(base: Fit, term: Term) -> Term:
    """The term with its nonlinear parameters moved to where the training cost is lowest.

    One without any is the likeliest of the effect's variants.

    Args:
        base: the fit to which it is added.
        term: with the parameters to begin with.
    """
    effect = CATALOGUE[term.effect]
    bounds = effect.shape_bounds(term.shape)
    free = effect.free(term.shape)
    if not free:
        return _likeliest(base, term)
    one_more = OneMore(base)

    def with_shape(values: FloatArray, *, again: bool = False) -> Term:
        shape = list(term.shape)
        for i, value in zip(free, values, strict=True):
            shape[i] = float(np.clip(value, *bounds[i]))
        make = base.balances.recent if again else base.balances.compute
        return replace(
            term,
            shape=tuple(shape),
            columns=make(effect, term.place, tuple(shape)),
            beneath=None,
        )

    def cost(x: Values, *, again: bool = False) -> float:
        new = with_shape(np.atleast_1d(x), again=again)
        return -one_more.gain(new) if new.columns else 1.0  # worse than without it

    if effect.costly:
        here = term.shape[0]
        tries = [here * 1.06**power for power in range(-6, 7)]  # simulated along with one another
        costs = [cost(value) for value in tries]
        best, lowest = np.array([tries[int(np.argmin(costs))]]), min(costs)
    elif len(free) == 1:
        best, lowest = _lowest(cost, *bounds[free[0]])
    else:
        start = np.array([term.shape[i] for i in free])
        result = optimize.minimize(
            cost,
            start,
            method="Nelder-Mead",
            bounds=[bounds[i] for i in free],
            options={"maxfev": 60, "xatol": 1e-3, "fatol": 1.0},
        )
        best, lowest = result.x, float(result.fun)
    return with_shape(best) if lowest < -one_more.gain(term) else term


def _likeliest(base: Fit, term: Term) -> Term:
    """The effect's variant there (a report is wrong, or a drive) that fits best."""
    b, effect = base.balances, CATALOGUE[term.effect]
    shapes = effect.shapes(b.motions, term.place)
    others = [s for s in shapes if effect.variant(s) != effect.variant(term.shape)]
    made = [term_of(b, effect, term.place, shape) for shape in others]
    found = [term, *(each for each in made if each is not None and each.width == term.width)]
    return max(found, key=OneMore(base).gain) if len(found) > 1 else term


class _Cost(Protocol):
    def __call__(self, x: Values, *, again: bool = False) -> float: ...


def _lowest(cost: _Cost, low: float, high: float) -> tuple[FloatArray, float]:
    """The best value of one parameter: on a grid that fits of the term share, then closer."""
    grid = np.linspace(low, high, _GRID)
    costs = [cost(x, again=True) for x in grid]
    k = int(np.argmin(costs))
    near = optimize.minimize_scalar(
        cost,
        bounds=(grid[max(k - 1, 0)], grid[min(k + 1, _GRID - 1)]),
        method="bounded",
        options={"xatol": 2e-3 * (high - low), "maxiter": 10},
    )
    best, lowest = (near.x, near.fun) if near.fun < costs[k] else (grid[k], costs[k])
    return np.array([float(best)]), float(lowest)
