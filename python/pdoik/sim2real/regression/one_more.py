"""What one term more would do to a fit, without fitting anew."""

from __future__ import annotations

import numpy as np
from scipy import linalg

from pdoik.recordings import FloatArray

from ..motion import Key
from .fit import TRACE, Fit, Term


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
