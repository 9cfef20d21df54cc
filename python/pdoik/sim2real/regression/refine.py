"""Nonlinear parameters, moved to where the training cost is lowest."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy import linalg, optimize

from pdoik.recordings import FloatArray

from ..effects import CATALOGUE
from ..motion import Key
from .fit import TRACE, Fit, Term, term_of


class OneMore:
    """A fit's residuals and factor, made once for all terms that are tried in addition to its own.

    By the Schur complement: only the balances where a term acts are looked at.
    """

    def __init__(self, fit: Fit) -> None:
        self._fit = fit
        self._scale, even = fit.even(fit.gram)
        try:
            whole = linalg.cho_solve(linalg.cho_factor(even), np.eye(fit.size))
            inverse = np.asarray(whole, dtype=np.float64)
        except linalg.LinAlgError:
            inverse = np.asarray(
                np.linalg.pinv(even, rcond=TRACE, hermitian=True), dtype=np.float64
            )
        self._inverse: FloatArray = inverse
        self._left: dict[Key, FloatArray] = {}

    def gain(self, term: Term) -> float:
        """The fall of the training cost with the term and everything else refitted.

        The same as `fit.cost() - fit.extended(term).cost()`.
        """
        fit, k = self._fit, 1 if term.fixed else term.width
        moment, gram, cross = np.zeros(k), np.zeros((k, k)), np.zeros((fit.size, k))
        for key, column in term.columns.items():
            if key in fit.design:
                part = column[fit.rows[key]] / fit.balances.sigma[key]
                moment += part.T @ self._residual(key)
                gram += part.T @ part
                cross[fit.index[key]] += fit.design[key].T @ part
        scaled = self._scale[:, None] * cross
        reduced = gram - cross.T @ (self._scale[:, None] * (self._inverse @ scaled))
        if term.fixed:
            return float(2.0 * moment[0] - reduced[0, 0])
        scale = 1.0 / np.sqrt(np.maximum(np.diag(gram) + term.prior, 1e-300))
        even = (reduced + np.diag(term.prior)) * np.outer(scale, scale) + 1e-9 * np.eye(k)
        return float(moment @ (scale * np.linalg.lstsq(even, scale * moment, rcond=TRACE)[0]))

    def _residual(self, key: Key) -> FloatArray:
        if key not in self._left:
            self._left[key] = self._fit.residual(key)
        return self._left[key]


def gains_alone(
    moments: FloatArray, grams: FloatArray, ridge: float = 1e-9
) -> tuple[FloatArray, FloatArray]:
    """Coefficients (G, k) of columns with all else as it is, and by how much costs fall, (G,).

    Args:
        moments: (G, k) of the columns with what is left.
        grams: (G, k, k) of the columns.
        ridge: share of a gram's trace that is added to its diagonal.
    """
    scale = np.trace(grams, axis1=1, axis2=2)
    size = np.maximum(ridge * scale, 1e-300)[:, None, None]
    even = grams + size * np.eye(grams.shape[1])
    betas = np.asarray(np.linalg.solve(even, moments[:, :, None])[:, :, 0])
    return betas, np.where(scale > 0.0, np.sum(betas * moments, axis=1), 0.0)


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
