"""What one term more would do to a fit, without fitting anew."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from ..motion.place import Key
from ..study.recording import FloatArray
from .fit import TRACE, Fit, Term

_Sums = tuple[FloatArray, FloatArray, FloatArray]
"""A term's column times residuals (k,), itself (k, k) and the fit's columns (w, k)."""


class OneMore:
    """A fit's residuals and factor, made once for all terms that are tried beside its own.

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
        self._last: tuple[Term, _Sums] | None = None

    def gain(self, term: Term) -> float:
        """By how much the training cost falls with the term and everything else refitted.

        That of `fit.cost() - fit.extended(term).cost()`.
        """
        moment, gram, cross = self._sums(term)
        reduced = gram - cross.T @ self._taken(cross)
        if term.fixed:
            return float(2.0 * moment[0] - reduced[0, 0])
        return float(moment @ _solved(term, gram, reduced, moment))

    def beta(self, term: Term) -> FloatArray:
        """Coefficients of `fit.extended(term)`."""
        moment, gram, cross = self._sums(term)
        taken = self._taken(cross)
        if term.fixed:
            return np.asarray(self._fit.beta - taken[:, 0])
        own = _solved(term, gram, gram - cross.T @ taken, moment)
        return np.concatenate([self._fit.beta - taken @ own, own])

    def doubt(self, index: NDArray[np.intp], rows: FloatArray) -> FloatArray:
        """Variance of what the fit says of other rows, (N,), in their noise's.

        Args:
            index: of the coefficients that act there, (w,).
            rows: their columns there, (N, w) in sigmas.
        """
        scale = self._scale[index]
        covariance = self._inverse[np.ix_(index, index)] * np.outer(scale, scale)
        return np.asarray(np.maximum(np.sum((rows @ covariance) * rows, axis=1), 0.0))

    def _sums(self, term: Term) -> _Sums:
        """A term's sums; the last ones are kept."""
        if self._last is None or self._last[0] is not term:
            self._last = term, self._summed(term)
        return self._last[1]

    def _summed(self, term: Term) -> _Sums:
        fit, k = self._fit, 1 if term.fixed else term.width
        moment, gram, cross = np.zeros(k), np.zeros((k, k)), np.zeros((fit.size, k))
        for key, column in term.columns.items():
            if key not in fit.design:
                continue
            part = column[fit.rows[key]] / fit.balances.sigma[key]
            moment += part.T @ self._residual(key)
            gram += part.T @ part
            if len(fit.index[key]):
                cross[fit.index[key]] += fit.design[key].against(part)
        return moment, gram, cross

    def _taken(self, cross: FloatArray) -> FloatArray:
        """What the fit's coefficients change by, (w, k)."""
        return np.asarray(
            self._scale[:, None] * (self._inverse @ (self._scale[:, None] * cross)),
            dtype=np.float64,
        )

    def _residual(self, key: Key) -> FloatArray:
        if key not in self._left:
            self._left[key] = self._fit.residual(key)
        return self._left[key]


def _solved(term: Term, gram: FloatArray, reduced: FloatArray, moment: FloatArray) -> FloatArray:
    """The term's own coefficients, by columns of even size, for (k,) or (k, m) moments."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram) + term.prior, 1e-300))
    even = (reduced + np.diag(term.prior)) * np.outer(scale, scale) + 1e-9 * np.eye(len(moment))
    found = np.linalg.lstsq(even, (scale * moment.T).T, rcond=TRACE)[0]
    return np.asarray((scale * found.T).T)
