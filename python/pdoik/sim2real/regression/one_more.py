"""What one term more would do to a fit, without fitting anew."""

from __future__ import annotations

import numpy as np
from scipy import linalg

from ..motion.place import Key
from ..study.recording import FloatArray
from .fit import Fit, Term

_TRACE = 1e-11  # of ridge, where columns are scaled to one


class OneMore:
    """A fit's residuals and factor, made once for all terms that are tried beside its own."""

    def __init__(self, fit: Fit) -> None:
        self._fit = fit
        self.cost = fit.cost()
        regular = fit.regular(fit.gram)
        self._scale = 1.0 / np.sqrt(np.diag(regular))
        even = regular * np.outer(self._scale, self._scale) + _TRACE * np.eye(fit.size)
        self._factor = linalg.cho_factor(even, check_finite=False) if fit.size else None
        self._left: dict[Key, FloatArray] = {}

    def cost_with(self, term: Term) -> float:
        """Training cost with the term and everything else refitted: `fit.extended(term).cost()`.

        By the Schur complement: only the balances where the term acts are looked at.
        """
        fit, k = self._fit, 1 if term.fixed else term.width
        moment, gram, cross = np.zeros(k), np.zeros((k, k)), np.zeros((fit.size, k))
        for key, column in term.columns.items():
            if key not in fit.design:
                continue
            part = column[fit.rows[key]] / fit.balances.sigma[key]
            moment += part.T @ self._residual(key)
            gram += part.T @ part
            if len(fit.index[key]):
                cross[fit.index[key]] += fit.design[key].T @ part
        if self._factor is not None:
            even = self._scale[:, None] * cross
            gram_left = gram - even.T @ linalg.cho_solve(self._factor, even, check_finite=False)
        else:
            gram_left = gram
        if term.fixed:
            return self.cost - float(2.0 * moment[0] - gram_left[0, 0])
        whole = np.diag(gram) + term.prior
        scale = 1.0 / np.sqrt(np.maximum(whole, 1e-300))
        left = (gram_left + np.diag(term.prior)) * np.outer(scale, scale) + 1e-9 * np.eye(k)
        along = scale * moment
        return self.cost - float(along @ np.linalg.lstsq(left, along, rcond=_TRACE)[0])

    def _residual(self, key: Key) -> FloatArray:
        if key not in self._left:
            self._left[key] = self._fit.residual(key)
        return self._left[key]
